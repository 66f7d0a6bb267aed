// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/robot_drivers.h"

#include "drivers/robot/can_driver.h"
#include "rt/run/process_config.h"

namespace sandrunner {

std::shared_ptr<const RobotDriver> read_robot_driver(ConfigTree& tree,
                                                     const ProcessConfig& config) {
  if (tree.has("hardware")) {
    return std::make_shared<CanDriver>(*config.hardware, config.robot.description,
                                       config.controller.gate);
  }
  return nullptr;
}

}  // namespace sandrunner
