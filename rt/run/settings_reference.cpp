// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/settings_reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "drivers/robot_drivers.h"
#include "rt/base/settings.h"
#include "rt/realtime/setup.h"
#include "rt/run/process_config.h"
#include "rt/telemetry/dds/dds_config.h"
#include "sim/ground/terrain_description.h"
#include "sim/robot/robot_model.h"
#include "sim/simulator.h"

namespace sandrunner {
namespace {

/// The settings whose first word is `table`.
struct Group {
  const char* table;
  const char* about;
};
constexpr Group kGroups[] = {
    {"robot", "The robot."},
    {"terrain",
     "The ground: the keys of a file of --terrain. Each preset sets its own. A [[terrain.patch]] "
     "has the keys\nfrom `kind` on, too, without `terrain.`; its two others are listed."},
    {"sim", "The simulator: noise and delays of its sensors, its drives, its solver."},
    {"policy", "The exchange with the policy."},
    {"controller",
     "The controller: gains and times of the modes, the envelope of commands, the thresholds of "
     "the safety\ngate. A limit is clamped or counted, a fault is latched. With [hardware], ages "
     "follow its rate_hz."},
    {"realtime",
     "What a real-time run requests from Linux. require: refuse to run without it; warn: report "
     "it; off: do\nnot request it."},
    {"dds", "Telemetry and commands over DDS."},
    {"view", "Pages in a browser (--view)."},
    {"hardware",
     "Drives and IMU of a real robot, usually in the file of --hardware: [[hardware.bus]] for each "
     "bus and\n[[hardware.drive]] for each joint."},
    {"recording", "Limits of a recording (--record)."},
    {"summary", "Figures of a run."},
};

std::vector<SettingLine> run_settings() {
  std::vector<SettingLine> all;
  for (const auto& part : {process_settings(), sim::terrain_settings(), sim::simulator_settings(),
                           realtime_settings(), dds_settings(), robot_driver_settings()}) {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

std::string table_of(std::span<const SettingLine> lines) {
  using Row = std::array<std::string, 5>;
  std::vector<Row> rows = {{"key", "default", "unit", "range", "meaning"}};
  for (const SettingLine& line : lines) {
    rows.push_back({line.key, line.fallback, line.unit, line.range, line.meaning});
  }
  std::array<std::size_t, 5> widths{};
  for (const Row& row : rows) {
    for (std::size_t i = 0; i + 1 < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  Row rule;
  std::ranges::transform(widths, rule.begin(), [](std::size_t width) {
    return std::string(std::max<std::size_t>(width, 3), '-');
  });
  rows.insert(rows.begin() + 1, rule);
  std::string text;
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      text += fmt::format("| {:<{}} ", row[i], widths[i]);
    }
    text += "|\n";
  }
  return text;
}

}  // namespace

std::string settings_reference() {
  std::string text;
  const std::vector<SettingLine> all = run_settings();
  for (const Group& group : kGroups) {
    std::vector<SettingLine> lines;
    std::ranges::copy_if(all, std::back_inserter(lines), [&](const SettingLine& line) {
      return line.key.substr(0, line.key.find('.')) == group.table;
    });
    text += fmt::format("#### {}\n{}\n\n{}\n", group.table, group.about, table_of(lines));
  }
  text += fmt::format(
      "#### The file of a robot\nIts keys (--robot FILE) are no settings of a run.\n\n{}",
      table_of(sim::robot_file_settings()));
  return text;
}

}  // namespace sandrunner
