// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "rt/core/robot_driver.h"

namespace sandrunner {

struct ProcessConfig;

/// The driver of the robot that `config` names, whose robot, controller and hardware are known by
/// then; null: there is none.
std::shared_ptr<RobotDriver> make_robot_driver(const ProcessConfig& config);

}  // namespace sandrunner
