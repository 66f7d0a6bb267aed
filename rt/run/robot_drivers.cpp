// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/robot_drivers.h"

#include "drivers/robot/can_driver.h"
#include "drivers/unitree/unitree_driver.h"
#include "rt/run/process_config.h"

namespace sandrunner {

std::shared_ptr<RobotDriver> make_robot_driver(const ProcessConfig& config) {
  const RobotDescription& robot = config.robot.description;
  if (config.hardware) {
    return std::make_shared<CanDriver>(*config.hardware, robot, config.controller.gate);
  }
  if (config.unitree) {
    return std::make_shared<UnitreeDriver>(*config.unitree, robot, config.controller);
  }
  return nullptr;
}

}  // namespace sandrunner
