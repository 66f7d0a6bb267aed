// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "rt/base/config_tree.h"
#include "rt/base/settings.h"
#include "rt/core/gate_config.h"

namespace sandrunner {

/// The table [hardware] of a robot of kind "unitree", and its table [hardware.unitree].
struct UnitreeConfig {
  double temperature_limit_degc = 80.0;  ///< a hotter motor is a warning
  double torque_scale = 1.0;             ///< of every torque limit, for first walks
  bool hanging = false;  ///< the robot hangs in a frame: falls and tilts are not judged

  std::string interface;  ///< network interface to the robot; "lo": this computer
  int domain = 0;
  int motor_mode = 0x01;           ///< of a motor that gives torque
  int tick_hz = 1000;              ///< of the clock in its states
  int low_battery_percent = 10;    ///< less is a warning, less than half of it a fault
  bool need_remote = true;         ///< a remote that is off or lost is an emergency stop
  bool release_sport_mode = true;  ///< false: another program has switched it off
};

/// Reads them. Throws InputError.
UnitreeConfig read_unitree_config(ConfigTree& config);
/// The keys that no other kind of hardware has, for the reference.
std::vector<SettingLine> unitree_settings();

/// Adapts the gate's thresholds to states that come 500 times a second over a network.
void fit_gate_to(const UnitreeConfig& unitree, GateConfig& gate) noexcept;

}  // namespace sandrunner
