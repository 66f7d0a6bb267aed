// SPDX-License-Identifier: BSD-3-Clause
// Checks before the first frame is sent whether another program commands the drives.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "drivers/robot/drive_look.h"
#include "drivers/robot/hardware_config.h"

namespace sandrunner {

/// A socket that receives every frame of the bus except its own. Throws InputError as CanSocket
/// does.
std::unique_ptr<CanSocket> open_bus(const BusConfig& bus);

inline constexpr int kListen_ms = 200;

/// Frames that came on one bus while this program sent nothing.
struct BusTraffic {
  int frames = 0;              ///< all but error frames
  JointArray<int> commands{};  ///< to the drive of each joint
  JointArray<int> replies{};   ///< of the drive of each joint
  void add(const HardwareConfig& config, int bus, const CanFrame& frame) noexcept;
};

/// Listens on all buses for kListen_ms; sends nothing. A bus without a socket (null) receives
/// nothing.
std::vector<BusTraffic> listen(const HardwareConfig& config, const CanSockets& sockets);

/// One line for each bus with traffic: drives only answer, so another program commands them.
std::vector<std::string> traffic_problems(const HardwareConfig& config,
                                          const RobotDescription& robot,
                                          const std::vector<BusTraffic>& traffic);

/// Opens all buses and listens. Throws InputError: as open_bus() does, or the first of
/// traffic_problems(). If another program drives the robot, switching the drives off would drop it.
CanSockets open_silent_buses(const HardwareConfig& config, const RobotDescription& robot);

}  // namespace sandrunner
