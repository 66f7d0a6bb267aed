// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/robot_drivers.h"

#include <array>

#include "drivers/robot/can_driver.h"
#include "rt/run/process_config.h"

namespace sandrunner {
namespace {

/// A driver of robots, and the table of its settings.
struct DriverRow {
  const char* table;
  std::shared_ptr<const RobotDriver> (*read)(ConfigTree& tree, const ProcessConfig& config);
};

constexpr std::array kDrivers = {
    DriverRow{"hardware",
              [](ConfigTree&, const ProcessConfig& config) -> std::shared_ptr<const RobotDriver> {
                return std::make_shared<CanDriver>(*config.hardware, config.robot.description,
                                                   config.controller.gate);
              }},
};

}  // namespace

std::shared_ptr<const RobotDriver> read_robot_driver(ConfigTree& tree,
                                                     const ProcessConfig& config) {
  for (const DriverRow& row : kDrivers) {
    if (tree.has(row.table)) return row.read(tree, config);
  }
  return nullptr;
}

}  // namespace sandrunner
