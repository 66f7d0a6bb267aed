// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "drivers/robot/drive.h"
#include "drivers/robot/hardware_config.h"

namespace sandrunner {

/// A frame as candump prints it: "  can0  001   [8]  FF FF ...".
std::string candump_line(const std::string& interface, const CanFrame& frame);

/// What would be sent to the robot, for a person: the plan of the buses, then of each drive the
/// frame that keeps it off, the one that enables it, and its command at `stand`, with what they say
/// at the drive's output, read back out of the bytes.
std::string dry_run(const HardwareConfig& config, const RobotDescription& robot,
                    const JointArray<JointSetPoint>& stand);

}  // namespace sandrunner
