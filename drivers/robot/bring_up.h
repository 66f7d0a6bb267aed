// SPDX-License-Identifier: BSD-3-Clause
// From a configuration to drives that answer. Nothing is enabled, nothing moves.
#pragma once

#include <memory>
#include <vector>

#include "drivers/can/can_socket.h"
#include "drivers/robot/hardware_config.h"

namespace sandrunner {

using CanSockets = std::vector<std::unique_ptr<CanSocket>>;

/// A socket for each bus that receives the replies of its drives. Throws InputError: what CanSocket
/// refuses, a bus that the plan overloads (bus_plan.h).
CanSockets open_buses(const HardwareConfig& config);

/// What a drive answered while it was looked for.
struct FoundDrive {
  int replies = 0;
  double position_rad = 0.0;  ///< of the joint
  double round_trip_s = 0.0;  ///< longest, from sending to the kernel's stamp
  std::uint64_t fault = 0;
  double temperature_degc = 0.0, voltage_v = 0.0;  ///< NaN: it does not say
};

inline constexpr int kLookExchanges = 50;

/// Tells each drive kLookExchanges times, 5 ms apart, to be off, and collects the answers.
JointArray<FoundDrive> look_for_drives(const HardwareConfig& config, const CanSockets& sockets);

/// Throws InputError, one line, unless each drive answers almost always, is where its joint can be,
/// has the limits that are configured and a time-out, as far as it can tell (a Damiao's is set).
void require_drives(const HardwareConfig& config, const RobotDescription& robot,
                    const GateConfig& gate, const CanSockets& sockets);

}  // namespace sandrunner
