// SPDX-License-Identifier: BSD-3-Clause
// From a configuration to drives that answer. Nothing is enabled, nothing moves.
#pragma once

#include <string>
#include <vector>

#include "drivers/robot/drive_look.h"
#include "drivers/robot/hardware_config.h"

namespace sandrunner {

inline constexpr int kLookExchanges = 50;

/// The problems of drives after at least kLookExchanges exchanges, one line each with joint, bus
/// and id. A drive must answer almost always and be at a possible position of its joint. It must
/// have the configured limits and a time-out, as far as it can report them; a Damiao's time-out is
/// set. Drives on a bus without a socket are left out.
std::vector<std::string> drive_problems(const HardwareConfig& config, const RobotDescription& robot,
                                        const GateConfig& gate, const CanSockets& sockets,
                                        const JointArray<FoundDrive>& found);

/// Looks at the drives; throws InputError with the first of drive_problems.
void require_drives(const HardwareConfig& config, const RobotDescription& robot,
                    const GateConfig& gate, const CanSockets& sockets);

}  // namespace sandrunner
