// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/imu/imu_config.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "rt/base/errors.h"

namespace sandrunner {

namespace {

constexpr double kMostLoad = 0.8;
constexpr int kBitsPerByte = 10;  // start bit, 8 data bits, stop bit

constexpr std::array<unsigned, 5> kMipBauds = {115200, 921600, 460800, 230400, 3000000};
constexpr std::array<unsigned, 5> kXsensBauds = {115200, 921600, 2000000, 460800, 230400};

/// Bytes of a packet with acceleration, angular rate, quaternion and time, and what of them the
/// quaternion takes, which is not in every packet.
struct PacketSize {
  double all, quaternion;
};

PacketSize packet_size(ImuProtocol protocol) noexcept {
  return protocol == ImuProtocol::kMip ? PacketSize{62, 18} : PacketSize{61, 19};
}

double bits_per_s(ImuProtocol protocol, int rate_hz, int quaternion_rate_hz) noexcept {
  const PacketSize size = packet_size(protocol);
  return kBitsPerByte *
         ((size.all - size.quaternion) * rate_hz + size.quaternion * quaternion_rate_hz);
}

}  // namespace

std::span<const unsigned> imu_bauds(ImuProtocol protocol) noexcept {
  return protocol == ImuProtocol::kMip ? kMipBauds : kXsensBauds;
}

double imu_line_load(const ImuConfig& config) noexcept {
  return bits_per_s(config.protocol, config.rate_hz, config.quaternion_rate_hz) / config.baud;
}

void check(const ImuConfig& config) {
  const int rate = config.rate_hz, quaternion_rate = config.quaternion_rate_hz;
  if (rate < 1 || rate > 1000) {
    refuse_imu(config.device, fmt::format("a rate of {} Hz is not within 1 to 1000 Hz", rate));
  }
  if (quaternion_rate < 1 || quaternion_rate > rate || rate % quaternion_rate != 0) {
    refuse_imu(config.device, fmt::format("a quaternion rate of {} Hz is not the rate of {} Hz "
                                          "over a whole number",
                                          quaternion_rate, rate));
  }
  const std::span<const unsigned> known = imu_bauds(config.protocol);
  std::vector<unsigned> bauds(known.begin(), known.end());
  std::sort(bauds.begin(), bauds.end());
  if (std::find(bauds.begin(), bauds.end(), config.baud) == bauds.end()) {
    refuse_imu(config.device,
               fmt::format("{} baud is none of {}", config.baud, fmt::join(bauds, ", ")));
  }
  const double load = imu_line_load(config);
  if (load <= kMostLoad) return;
  std::string way_out;
  for (const unsigned baud : bauds) {
    ImuConfig faster = config;
    faster.baud = baud;
    if (imu_line_load(faster) > kMostLoad) continue;
    way_out = fmt::format("{} baud is enough, or ", baud);
    break;
  }
  refuse_imu(
      config.device,
      fmt::format("samples at {} Hz with quaternions at {} Hz need {:.0f} bit/s, {:.0f} % of "
                  "{} baud, and at most {:.0f} % may be used: {}at most {:.0f} Hz of both",
                  rate, quaternion_rate, bits_per_s(config.protocol, rate, quaternion_rate),
                  100 * load, config.baud, 100 * kMostLoad, way_out,
                  std::floor(kMostLoad * config.baud / bits_per_s(config.protocol, 1, 1))));
}

void refuse_imu(const std::string& device, const std::string& why) {
  throw InputError(one_line(fmt::format("IMU {}: {}", device, why)));
}

}  // namespace sandrunner
