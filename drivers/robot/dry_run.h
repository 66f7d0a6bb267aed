// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "drivers/robot/drive.h"
#include "drivers/robot/hardware_config.h"

namespace sandrunner {

/// A frame as candump prints it: "  can0  001   [8]  FF FF ...".
std::string candump_line(const std::string& interface, const CanFrame& frame);

/// The frames for the robot as text: the plan of the buses, then for each drive the off frame, the
/// enable frame, and its command at `stand`, each with its meaning at the drive's output, decoded
/// from the bytes.
std::string dry_run(const HardwareConfig& config, const RobotDescription& robot,
                    const JointArray<JointSetPoint>& stand);

}  // namespace sandrunner
