// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "drivers/robot/drive.h"
#include "drivers/robot/hardware_config.h"

namespace sandrunner {

/// A frame as candump prints it: "  can0  001   [8]  FF FF ...".
std::string candump_line(const std::string& interface, const CanFrame& frame);

/// The frames for the robot as text. First comes the plan of the buses. Then each drive has its off
/// frame, its enable frame, and its command at `stand`, with their meanings at the drive's output,
/// decoded from the bytes.
std::string dry_run(const HardwareConfig& config, const RobotDescription& robot,
                    const JointArray<SetPoint>& stand);

}  // namespace sandrunner
