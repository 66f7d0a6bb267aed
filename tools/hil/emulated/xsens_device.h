// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "drivers/imu/imu_reading.h"
#include "drivers/imu/xsens.h"

namespace sandrunner::xsens {

/// The other end of the line: answers messages and sends data as an MTi does. Bytes in, bytes out;
/// no clock and no I/O. For the bench's emulated IMU and for tests.
class Device {
 public:
  /// Rates are `most_rate_hz` over a whole number. `baud`: of its line, which it keeps.
  Device(std::uint16_t most_rate_hz, std::uint32_t baud)
      : most_rate_hz_(most_rate_hz), baud_(baud) {}

  /// The answers to what the host has sent.
  std::vector<std::uint8_t> receive(Bytes bytes);

  /// One period of the greatest rate goes by: the message of what of the reading is due, or
  /// nothing. Sample time, quaternion, acceleration and rate of turn are offered.
  std::vector<std::uint8_t> tick(const ImuReading& reading);

  bool streaming() const { return measuring_; }
  std::uint32_t baud() const { return baud_; }

 private:
  Message answer(std::uint8_t id, Bytes data);
  Message set(Bytes outputs);
  bool due(std::uint16_t id) const;

  std::uint16_t most_rate_hz_;
  std::uint32_t baud_;
  Parser parser_;
  bool measuring_ = true;  // after power-up, what it was set to last
  std::vector<Output> outputs_{{kSampleTime, kEveryMessage}, {kQuaternionNwu, 100}};
  std::uint64_t ticks_ = 0;
};

}  // namespace sandrunner::xsens
