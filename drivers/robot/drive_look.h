// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/can/can_socket.h"
#include "drivers/robot/drive.h"
#include "drivers/robot/hardware_config.h"

namespace sandrunner {

/// Of each bus of a configuration.
using CanSockets = std::vector<std::unique_ptr<CanSocket>>;

/// The answers of a drive during the search.
struct FoundDrive {
  int requests = 0, replies = 0;
  int commands = 0;           ///< of other programs, to this drive
  double position_rad = 0.0;  ///< of the joint, newest
  double round_trip_s = 0.0,
         longest_round_trip_s = 0.0;  /// from sending to the kernel's stamp; mean
  std::uint64_t fault = 0;
  double temperature_degc = 0.0, voltage_v = 0.0;  ///< NaN: not reported
};

/// Other events on a bus meanwhile.
struct FoundBus {
  int not_sent = 0;        ///< requests that it rejected
  int foreign = 0;         ///< frames that are no reply of a drive of the configuration
  int error_frames = 0;    ///< reports of its controller
  std::string error = {};  ///< the gravest content of the last one
};

/// Sends off frames to every drive repeatedly, which moves nothing, and reads the answers.
class DriveLook {
 public:
  static constexpr double kExchange_s = 0.005;

  /// Both outlive it. A bus without a socket (null) is left out.
  DriveLook(const HardwareConfig& config, const CanSockets& sockets);

  /// One request to each drive; returns after kExchange_s.
  void exchange();

  /// The same, but drives with a set-point are enabled, and then get it; after an exchange of the
  /// robot's own rate. For the nudge alone (drivers/check/nudge.h).
  void exchange_powered(const JointArray<std::optional<SetPoint>>& points);

  const JointArray<FoundDrive>& drives() const noexcept { return found_; }
  const Drive& drive(int j) const noexcept { return drives_[j]; }
  /// Control ticks since the beginning, as Drive::tick().
  std::uint64_t tick() const noexcept;
  const std::vector<FoundBus>& buses() const noexcept { return buses_; }
  JointArray<double> position_rad() const noexcept;

 private:
  void send(int j, const CanFrame& frame);
  void receive(double wait_s);
  void take(std::size_t bus, const ReceivedFrame& received);

  const HardwareConfig& config_;
  const CanSockets& sockets_;
  JointArray<Drive> drives_;
  JointArray<FoundDrive> found_;
  JointArray<std::int64_t> sent_ns_{};
  std::vector<FoundBus> buses_;
  std::int64_t start_ns_;  ///< CLOCK_MONOTONIC
};

}  // namespace sandrunner
