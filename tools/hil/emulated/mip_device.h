// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "drivers/imu/imu_reading.h"
#include "drivers/imu/mip.h"

namespace sandrunner::mip {

/// The other end of the line: answers commands and makes data packets as a MicroStrain sensor does.
/// Bytes in, bytes out; no clock and no I/O. For the bench's emulated IMU and for tests.
class Device {
 public:
  /// `baud`: at which it listens after power-up. `base_rate_hz`: of kSensorData.
  Device(std::uint16_t base_rate_hz, std::uint32_t baud)
      : base_rate_hz_(base_rate_hz), baud_(baud) {}

  /// The replies to what the host has sent.
  std::vector<std::uint8_t> receive(Bytes bytes);

  /// One period of the base rate goes by: the packet of what of the reading is due, or nothing.
  /// Acceleration, angular rate, quaternion and reference time are offered.
  std::vector<std::uint8_t> tick(const ImuReading& reading);

  bool streaming() const { return stream_on_ && !idle_; }
  /// Speed of the line; a new one holds for what is sent after the replies to its command.
  std::uint32_t baud() const { return baud_; }

 private:
  /// The acknowledgement's code; `response` gets what the reply holds besides.
  std::uint8_t obey(std::uint8_t descriptor_set, const Field& command,
                    std::optional<Packet>& response);
  std::uint8_t set_format(Bytes data);

  std::uint16_t base_rate_hz_;
  std::uint32_t baud_;
  Parser parser_;
  bool idle_ = false;
  bool stream_on_ = false;
  std::vector<DecimatedField> format_;
  std::uint64_t ticks_ = 0;
};

}  // namespace sandrunner::mip
