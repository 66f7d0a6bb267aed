// SPDX-License-Identifier: BSD-3-Clause
// The zeros of the drives, from a robot that is held in a known pose, and their way into the file.
#pragma once

#include <string>
#include <vector>

#include "drivers/check/hand_move.h"
#include "drivers/robot/hardware_config.h"

namespace sandrunner {

/// A joint that is held still stays within this.
inline constexpr double kHeldStill_rad = 0.01;

/// The zero_rad of every drive for which the positions in `trace` (measured with the zeros of
/// `config`) equal `pose_rad`. Throws InputError, one line: nothing was measured, a joint moved
/// meanwhile, or a zero is more than a turn away.
JointArray<double> zeros_of(const JointTrace& trace, const JointArray<double>& pose_rad,
                            const HardwareConfig& config, const RobotDescription& robot);

/// The TOML of a hardware file, `name` in errors, with these values of zero_rad in the tables
/// [[hardware.drive]] of the joints, and every other byte as it was; a table without the key gets
/// it below its joint. Throws InputError if a joint has no such table.
std::string with_zeros(const std::string& text, const std::string& name,
                       const JointArray<double>& zero_rad, const RobotDescription& robot);

}  // namespace sandrunner
