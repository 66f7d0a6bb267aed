// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "drivers/imu/imu.h"
#include "tests/drivers/imu/pty.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"
#include "tools/hil/emulated/mip_device.h"
#include "tools/hil/emulated/xsens_device.h"

namespace sandrunner {

inline constexpr std::int64_t kMs = 1'000'000;

/// An IMU on the far end of a serial line. While the driver sets it up a thread speaks for it; then
/// the test does, in the time that it makes up.
class ImuTest : public testing::Test {
 protected:
  using Device = std::variant<mip::Device, xsens::Device>;
  using ByteVector = std::vector<std::uint8_t>;

  explicit ImuTest(ImuProtocol protocol) : protocol_(protocol), device_(new_device()) {}

  /// What the reader is commanded to do, by the name under which the line is found.
  ImuConfig config() const {
    ImuConfig config;
    config.protocol = protocol_;
    config.device = link_;
    config.rate_hz = config.quaternion_rate_hz = is_mip() ? 500 : 400;
    return config;
  }
  bool is_mip() const { return protocol_ == ImuProtocol::kMip; }
  Device new_device() const {
    if (is_mip()) return mip::Device(1000, 921600);
    return xsens::Device(400, 921600);
  }

  void plug_in() {
    pty_ = std::make_unique<Pty>();
    std::filesystem::remove(link_);
    std::filesystem::create_symlink(pty_->path(), link_);
  }

  /// The reader, set up; all that the device has sent meanwhile is read.
  std::unique_ptr<Imu> set_up(const ImuConfig& config) {
    std::unique_ptr<Imu> imu;
    {
      const std::jthread server([this](const std::stop_token& stop) { serve(stop); });
      imu = std::make_unique<Imu>(config);
    }
    now_ns_ = real_now_ns();
    ImuReading marker = reading();
    marker.angular_velocity_radps = Vector3{7.0, 0.0, 0.0};
    pty_->write(bytes_of(marker));
    poll_until(*imu, [&] { return imu->sample().angular_velocity_radps[0] == 7.0; });
    return imu;
  }
  std::string refusal(const ImuConfig& config) {
    const std::jthread server([this](const std::stop_token& stop) { serve(stop); });
    return error_of([&] { const Imu imu(config); });
  }

  /// The next one: at rest, level, a period later on the device's clock.
  ImuReading reading(std::uint64_t period_ns = 2 * kMs) {
    device_ns_ += period_ns;
    return {.device_ns = device_ns_,
            .acceleration_mps2 = Vector3{0.0, 0.0, kStandardGravity_mps2},
            .angular_velocity_radps = Vector3{0.0, 0.5, 0.0},
            .orientation_wxyz = std::array<double, 4>{1.0, 0.0, 0.0, 0.0}};
  }
  /// How it is sent.
  ByteVector bytes_of(const ImuReading& reading) const {
    if (is_mip()) return copy(mip::encode_sensor_data(to_mip(reading)).bytes());
    return copy(xsens::encode_sensor_data(to_xsens(reading)).bytes());
  }
  static ByteVector copy(Bytes bytes) { return {bytes.begin(), bytes.end()}; }

  /// Sends, and polls until all of it has arrived.
  void send(Imu& imu, Bytes bytes) {
    const std::uint64_t wanted = imu.counters().bytes + bytes.size();
    pty_->write(bytes);
    poll_until(imu, [&] { return imu.counters().bytes >= wanted; });
  }
  void send(Imu& imu, const ImuReading& reading) { send(imu, bytes_of(reading)); }
  template <typename Holds>
  void poll_until(Imu& imu, Holds holds) {
    const std::int64_t deadline_ns = real_now_ns() + 5000 * kMs;
    while (!holds()) {
      ASSERT_LT(real_now_ns(), deadline_ns) << "did not arrive";
      imu.poll(now_ns_);
      sched_yield();
    }
  }
  /// Some good samples, 2 ms apart.
  void stream(Imu& imu, int count) {
    for (int i = 0; i < count; ++i) {
      now_ns_ += 2 * kMs;
      send(imu, reading());
    }
  }

  bool streaming() const {
    return std::visit([](const auto& device) { return device.streaming(); }, device_);
  }
  std::uint32_t device_baud() const {
    return std::visit([](const auto& device) { return device.baud(); }, device_);
  }
  ByteVector tell_device(Bytes bytes) {
    return std::visit([&](auto& device) { return device.receive(bytes); }, device_);
  }

  const ImuProtocol protocol_;
  TemporaryFolder folder_;
  std::string link_ = folder_.path("imu");
  std::unique_ptr<Pty> pty_;
  Device device_;
  bool mute_ = false;
  std::atomic<std::uint8_t> forgotten_{0};  ///< commands with this third byte: unanswered once
  std::function<ByteVector(ByteVector)> edited_ = [](ByteVector answer) { return answer; };
  std::uint64_t device_ns_ = 1'000'000'000;
  std::int64_t now_ns_ = 0;

 private:
  void SetUp() override { plug_in(); }

  static std::int64_t real_now_ns() {
    return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
  }

  void serve(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      ByteVector bytes = pty_->read(2);
      if (mute_) continue;
      if (pty_->baud() != device_baud()) {
        // At another speed the two hear nothing but garbage of each other.
        for (auto& byte : bytes) byte = static_cast<std::uint8_t>(byte * 37 + 11);
      } else if (bytes.size() > 2 && bytes[2] == forgotten_) {
        forgotten_ = 0;
        continue;
      }
      ByteVector answer = edited_(tell_device(bytes));
      for (int tick = 0; tick < 2; ++tick) {  // of its greatest rate
        const ImuReading next = reading(is_mip() ? kMs : kMs * 5 / 2);
        const ByteVector data =
            std::visit([&](auto& device) { return device.tick(next); }, device_);
        answer.insert(answer.end(), data.begin(), data.end());
      }
      pty_->write(answer);
    }
  }
};

}  // namespace sandrunner
