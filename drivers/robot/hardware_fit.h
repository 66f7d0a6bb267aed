// SPDX-License-Identifier: BSD-3-Clause
// How the safety gate and the drives of one robot are made to agree, and what neither guards.
#pragma once

#include <string>
#include <vector>

#include "drivers/robot/hardware_config.h"

namespace sandrunner {

/// Adapts the gate's thresholds to the hardware: ages follow the rate of the exchange, the speed
/// fault stays below the speed that replies can report, torque limits are scaled by `torque_scale`,
/// and `hanging` is copied.
void fit_gate_to(const HardwareConfig& hardware, GateConfig& gate) noexcept;

/// Adapts the drives to the gate's own settings, which are read after that. A drive whose commands
/// have a torque limit gets the joint's and enforces it itself, even if this computer fails. Throws
/// InputError for a time-out that is not longer than the stall that the gate tolerates, as
/// drives would switch off without a fault. Also for a speed fault above the speed that replies can
/// report.
void fit_drives_to(const GateConfig& gate, HardwareConfig& hardware);

/// One line for each guard of the robot that the file leaves off: the emergency stop, the range of
/// the supply.
std::vector<std::string> unguarded(const HardwareConfig& config);

}  // namespace sandrunner
