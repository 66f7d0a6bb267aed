// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "rt/base/config_tree.h"
#include "rt/base/settings.h"
#include "rt/core/gate_config.h"
#include "rt/core/robot_description.h"
#include "rt/core/robot_driver.h"

namespace sandrunner {

/// The driver that `hardware.kind` names, with its settings; null: there is no table [hardware].
/// `limits`: of the robot's file. Throws InputError.
std::shared_ptr<RobotDriver> make_robot_driver(ConfigTree& config, const RobotDescription& robot,
                                               const GateConfig& limits);

/// The keys of [hardware], for the reference.
std::vector<SettingLine> robot_driver_settings();

}  // namespace sandrunner
