// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "drivers/imu/imu_config.h"
#include "drivers/imu/serial_port.h"
#include "tools/hil/emulated/mip_device.h"
#include "tools/hil/emulated/xsens_device.h"

namespace sandrunner::hil {

enum class ImuFault : std::uint8_t {
  kNone,
  kSilent,
  kRepeating,  ///< its last packet again and again
  kGarbage,    ///< bytes that are no packets
};

/// An emulated sensor of the configured protocol on a serial line: the far end of a cable, or a
/// pseudo-terminal.
class ImuLine {
 public:
  /// `config`: the controller's. `device` is opened as this end of the line. Empty: a
  /// pseudo-terminal is made, and the configured device is a symbolic link to the controller's end
  /// of it, which must not exist as anything else. Throws InputError.
  ImuLine(const std::string& device, const ImuConfig& config);
  ~ImuLine();
  ImuLine(const ImuLine&) = delete;
  ImuLine& operator=(const ImuLine&) = delete;

  /// Answers what the controller asks.
  void listen();
  /// A period of `base_rate_hz` has passed. `now_ns`: the sensor's own clock.
  void tick(const ImuSample& sample, std::uint64_t now_ns);
  /// That of a 3DM-CV7, or the greatest of an MTi-600; both divide the control rate.
  int base_rate_hz() const noexcept { return base_rate_hz_; }

  /// The plug is pulled, for good.
  void unplug();

  std::uint64_t packets() const noexcept { return packets_; }
  std::uint64_t not_taken() const noexcept { return not_taken_; }  ///< nobody read the line

  ImuFault fault = ImuFault::kNone;

 private:
  void write(Bytes bytes);
  std::uint32_t baud() const;

  ImuMounting mounting_;
  int base_rate_hz_;
  std::variant<mip::Device, xsens::Device> device_;
  std::optional<SerialPort> port_;
  std::vector<std::uint8_t> last_;
  int terminal_ = -1;
  std::string link_;
  std::uint64_t packets_ = 0, not_taken_ = 0;
};

}  // namespace sandrunner::hil
