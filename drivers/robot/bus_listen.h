// SPDX-License-Identifier: BSD-3-Clause
// Whether another program talks to the drives, before the first frame is sent.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "drivers/robot/drive_look.h"
#include "drivers/robot/hardware_config.h"

namespace sandrunner {

/// A socket that receives every frame of the bus but its own. Throws InputError: what CanSocket
/// refuses.
std::unique_ptr<CanSocket> open_bus(const BusConfig& bus);

inline constexpr int kListen_ms = 200;

/// Frames on one bus while nothing was sent.
struct HeardBus {
  int frames = 0;              ///< all but error frames
  JointArray<int> commands{};  ///< to the drive of each joint
  JointArray<int> replies{};   ///< of the drive of each joint
  void hear(const HardwareConfig& config, int bus, const CanFrame& frame) noexcept;
};

/// Listens on all buses for kListen_ms; sends nothing. A bus without a socket (null) hears nothing.
std::vector<HeardBus> listen(const HardwareConfig& config, const CanSockets& sockets);

/// A line for each bus on which something was heard: drives speak only when spoken to, so another
/// program commands them.
std::vector<std::string> traffic_problems(const HardwareConfig& config,
                                          const RobotDescription& robot,
                                          const std::vector<HeardBus>& heard);

/// Opens all buses and listens. Throws InputError: what open_bus() throws, or the first of
/// traffic_problems(). A robot that another program drives would fall if its drives were switched
/// off.
CanSockets open_silent_buses(const HardwareConfig& config, const RobotDescription& robot);

}  // namespace sandrunner
