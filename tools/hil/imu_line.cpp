// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/imu_line.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdlib.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <vector>

#include "rt/base/errors.h"

namespace sandrunner::hil {
namespace {

namespace fs = std::filesystem;

constexpr int kMipBaseRate_hz = 1000, kXsensRate_hz = 400;
constexpr unsigned kMipBaud = 115200;  // after power-up, until it receives another one

/// Opens a pseudo-terminal whose other end is `link`.
int open_terminal(const std::string& link) {
  const fs::file_status there = fs::symlink_status(link);
  if (fs::exists(there) && !fs::is_symlink(there)) {
    throw InputError(fmt::format(
        "IMU {}: is there already: --imu names this end of a line, or hardware.imu.device a link "
        "that the bench may make (/tmp/imu)",
        link));
  }
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  std::array<char, 64> name{};
  if (terminal < 0 || grantpt(terminal) != 0 || unlockpt(terminal) != 0 ||
      ptsname_r(terminal, name.data(), name.size()) != 0) {
    const int error = errno;
    if (terminal >= 0) close(terminal);
    throw InputError(fmt::format("IMU {}: no pseudo-terminal: {}", link, strerror(error)));
  }
  std::error_code error;
  fs::remove(link, error);
  fs::create_symlink(name.data(), link, error);
  if (error) {
    close(terminal);
    throw InputError(fmt::format("IMU {}: no link can be made: {}", link, error.message()));
  }
  return terminal;
}

}  // namespace

ImuLine::ImuLine(const std::string& device, const ImuConfig& config)
    : mounting_(config.mounting),
      base_rate_hz_(config.protocol == ImuProtocol::kMip ? kMipBaseRate_hz : kXsensRate_hz),
      device_(mip::Device(kMipBaseRate_hz, kMipBaud)) {
  // An MTi keeps its speed: it has been set to the configured one.
  if (config.protocol == ImuProtocol::kXsens) device_ = xsens::Device(kXsensRate_hz, config.baud);
  if (device.empty()) {
    terminal_ = open_terminal(config.device);
    link_ = config.device;
  } else {
    port_.emplace(device, baud());
  }
}

ImuLine::~ImuLine() { unplug(); }

void ImuLine::unplug() {
  if (terminal_ >= 0) {
    close(terminal_);
    std::error_code ignored;
    fs::remove(link_, ignored);
  }
  terminal_ = -1;
  port_.reset();
}

std::uint32_t ImuLine::baud() const {
  return std::visit([](const auto& device) { return device.baud(); }, device_);
}

void ImuLine::write(Bytes bytes) {
  if (port_) {
    port_->write(bytes);
  } else if (terminal_ >= 0 && ::write(terminal_, bytes.data(), bytes.size()) < 0) {
    ++not_taken_;
  }
}

void ImuLine::listen() {
  std::array<std::uint8_t, 256> bytes;
  const auto count = port_            ? ssize_t{port_->read(bytes)}
                     : terminal_ >= 0 ? ::read(terminal_, bytes.data(), bytes.size())
                                      : ssize_t{0};
  if (count <= 0 || fault != ImuFault::kNone) return;
  const std::uint32_t before = baud();
  const Bytes heard(bytes.data(), static_cast<std::size_t>(count));
  const std::vector<std::uint8_t> replies =
      std::visit([&](auto& sensor) { return sensor.receive(heard); }, device_);
  if (!replies.empty()) write(replies);
  if (port_ && baud() != before) port_->set_baud(baud());
}

void ImuLine::tick(const ImuSample& sample, std::uint64_t now_ns) {
  ImuReading reading = mounting_.to_sensor(sample);
  reading.device_ns = now_ns;
  std::vector<std::uint8_t> packet =
      std::visit([&](auto& sensor) { return sensor.tick(reading); }, device_);
  if (packet.empty()) return;
  switch (fault) {
    case ImuFault::kNone:
      last_ = packet;
      write(packet);
      ++packets_;
      break;
    case ImuFault::kSilent:
      break;
    case ImuFault::kRepeating:
      if (!last_.empty()) write(last_);
      break;
    case ImuFault::kGarbage:
      for (std::uint8_t& byte : packet) byte ^= 0xA5;
      write(packet);
      break;
  }
}

}  // namespace sandrunner::hil
