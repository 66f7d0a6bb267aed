// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "drivers/imu/imu_mounting.h"

namespace sandrunner {

enum class ImuProtocol : std::uint8_t {
  kMip,   ///< MicroStrain that knows the commands of the 3DM-CV7 (a GX5's manual has others)
  kXsens  ///< MTi that sends MTData2
};

/// An IMU on a serial line.
struct ImuConfig {
  ImuProtocol protocol = ImuProtocol::kMip;
  std::string device;            ///< better its name in /dev/serial/by-id than /dev/ttyUSB0
  unsigned baud = 921600;        ///< of imu_bauds()
  int rate_hz = 500;             ///< acceleration, angular rate, device time
  int quaternion_rate_hz = 500;  ///< attitude: `rate_hz`, or that over a whole number
  ImuMounting mounting;
};

/// Speeds at which a device is looked for, the most likely ones first. MIP: those of the 3DM-CV7
/// (user manual, "Protocol Support"; 3,000,000 with GNSS only). Xsens: those of the MTi-600's UART
/// from 115200 up (hardware integration manual, "Communication to host").
std::span<const unsigned> imu_bauds(ImuProtocol protocol) noexcept;

/// What of the line the stream takes: 10 bits a byte.
double imu_line_load(const ImuConfig& config) noexcept;
/// InputError, one line, if the configuration can't work with any device: rates, speed, or a stream
/// that takes more than 80 % of the line. Needs no device.
void check(const ImuConfig& config);

/// Throws InputError: one line that names the IMU by its serial line.
[[noreturn]] void refuse_imu(const std::string& device, const std::string& why);

}  // namespace sandrunner
