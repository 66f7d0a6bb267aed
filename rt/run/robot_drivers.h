// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "rt/base/config_tree.h"
#include "rt/core/robot_driver.h"

namespace sandrunner {

struct ProcessConfig;

/// The driver whose table of settings is in `tree`, which reads it; null: there is none. Of
/// `config`, robot, gate and [hardware] are known by then. Throws InputError.
std::shared_ptr<const RobotDriver> read_robot_driver(ConfigTree& tree, const ProcessConfig& config);

}  // namespace sandrunner
