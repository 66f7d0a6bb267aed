// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/robot_drivers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>

#include "drivers/can_driver.h"
#include "drivers/unitree/unitree_driver.h"

namespace sandrunner {
namespace {

struct Row {
  const char* kind;
  const char* what;
  std::vector<SettingLine> (*settings)();
  std::shared_ptr<RobotDriver> (*make)(ConfigTree& config, const RobotDescription& robot,
                                       const GateConfig& limits);
};

template <typename Driver>
std::shared_ptr<RobotDriver> make(ConfigTree& config, const RobotDescription& robot,
                                  const GateConfig& limits) {
  return std::make_shared<Driver>(config, robot, limits);
}

// The first is that of a table without a kind.
constexpr Row kRows[] = {
    {"can", "drives on CAN buses and a serial IMU", hardware_settings, make<CanDriver>},
    {"unitree", "a Go2 EDU (drivers/unitree/README.md)", unitree_settings, make<UnitreeDriver>},
};

std::vector<std::string> kinds() {
  std::vector<std::string> kinds;
  for (const Row& row : kRows) kinds.emplace_back(row.kind);
  return kinds;
}

}  // namespace

std::shared_ptr<RobotDriver> make_robot_driver(ConfigTree& config, const RobotDescription& robot,
                                               const GateConfig& limits) {
  if (!config.has("hardware")) return nullptr;
  const std::string kind = config.choice("hardware.kind", kRows[0].kind, kinds());
  return std::ranges::find(kRows, kind, &Row::kind)->make(config, robot, limits);
}

std::vector<SettingLine> robot_driver_settings() {
  std::vector<std::string> meanings;
  for (const Row& row : kRows) meanings.push_back(fmt::format("{}: {}", row.kind, row.what));
  std::vector<SettingLine> lines = {{.key = "hardware.kind",
                                     .fallback = kRows[0].kind,
                                     .unit = "",
                                     .range = fmt::format("{}", fmt::join(kinds(), ", ")),
                                     .meaning = fmt::format("{}.", fmt::join(meanings, "; "))}};
  for (const Row& row : kRows) std::ranges::copy(row.settings(), std::back_inserter(lines));
  return lines;
}

}  // namespace sandrunner
