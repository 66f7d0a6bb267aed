// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "drivers/imu/imu_mounting.h"
#include "drivers/imu/mip_device.h"
#include "drivers/imu/serial_port.h"

namespace sandrunner::hil {

enum class ImuFault : std::uint8_t {
  kNone,
  kSilent,
  kRepeating,  ///< its last packet again and again
  kGarbage,    ///< bytes that are no packets
};

/// An emulated MicroStrain sensor on a serial line: the far end of a cable, or a pseudo-terminal.
class ImuLine {
 public:
  /// `device` is opened as this end of the line. Empty: a pseudo-terminal is made, and `link` is a
  /// symbolic link to the controller's end of it, which must not exist as anything else. Throws
  /// InputError.
  ImuLine(const std::string& device, const std::string& link, const ImuMounting& mounting);
  ~ImuLine();
  ImuLine(const ImuLine&) = delete;
  ImuLine& operator=(const ImuLine&) = delete;

  /// Answers what the controller asks.
  void listen();
  /// A period of kBaseRate_hz has passed. `now_ns`: the sensor's own clock.
  void tick(const ImuSample& sample, std::uint64_t now_ns);
  static constexpr int kBaseRate_hz = 1000;

  /// The plug is pulled, for good.
  void unplug();

  std::uint64_t packets() const noexcept { return packets_; }
  std::uint64_t not_taken() const noexcept { return not_taken_; }  ///< nobody read the line

  ImuFault fault = ImuFault::kNone;

 private:
  void write(mip::Bytes bytes);

  ImuMounting mounting_;
  mip::Device device_{kBaseRate_hz, 115200};
  std::optional<SerialPort> port_;
  std::optional<mip::Packet> last_;
  int terminal_ = -1;
  std::string link_;
  std::uint64_t packets_ = 0, not_taken_ = 0;
};

}  // namespace sandrunner::hil
