// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/experiments/runs.h"

#include <limits>

#include "tools/evaluate/statistics.h"

namespace sandrunner::study {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::map<std::string, std::vector<double>> lists_from(const Json& json) {
  std::map<std::string, std::vector<double>> lists;
  for (const auto& [name, values] : json.items()) {
    std::vector<double>& list = lists[name];
    for (const Json& value : values) list.push_back(value.is_null() ? kNan : value.get<double>());
  }
  return lists;
}

}  // namespace

Json to_json(const Measured& measured) {
  Json groups = Json::array();
  for (const RunGroup& group : measured.groups) {
    groups.push_back({{"ground", group.ground},
                      {"scenario", group.scenario},
                      {"command", group.command},
                      {"runs", group.runs},
                      {"lists", group.lists},
                      {"packed", group.packed}});
  }
  return groups;
}

Measured measured_from(const Json& json) {
  Measured measured;
  for (const Json& group : json) {
    measured.groups.push_back({group.at("ground").get<std::string>(),
                               group.at("scenario").get<std::string>(),
                               group.at("command").get<double>(), lists_from(group.at("runs")),
                               lists_from(group.at("lists")),
                               group.at("packed").get<std::map<std::string, std::string>>()});
  }
  return measured;
}

double mean_of(const std::vector<double>& values) { return evaluate::mean_interval(values).value; }

}  // namespace sandrunner::study
