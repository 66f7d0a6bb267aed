// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/evidence/runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>

#include "rt/base/quantile.h"

namespace sandrunner::study {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Json lists_json(const std::map<std::string, std::vector<double>>& lists) {
  Json json = Json::object();
  for (const auto& [name, values] : lists) json[name] = values;  // nan becomes null
  return json;
}

std::map<std::string, std::vector<double>> lists_from(const Json& json) {
  std::map<std::string, std::vector<double>> lists;
  for (const auto& [name, values] : json.items()) {
    std::vector<double>& list = lists[name];
    for (const Json& value : values) list.push_back(value.is_null() ? kNan : value.get<double>());
  }
  return lists;
}

}  // namespace

const std::vector<double>& RunGroup::values(const std::string& figure) const {
  const auto found = runs.find(figure);
  if (found == runs.end()) {
    throw std::logic_error(fmt::format("no figure '{}' on {} {}", figure, ground, scenario));
  }
  return found->second;
}

std::vector<const RunGroup*> Measured::select(const std::string& ground,
                                              const std::string& scenario) const {
  std::vector<const RunGroup*> found;
  for (const RunGroup& group : groups) {
    if (group.ground == ground && group.scenario == scenario) found.push_back(&group);
  }
  return found;
}

Json to_json(const Measured& measured) {
  Json groups = Json::array();
  for (const RunGroup& group : measured.groups) {
    groups.push_back({{"ground", group.ground},
                      {"scenario", group.scenario},
                      {"command", group.command},
                      {"runs", lists_json(group.runs)},
                      {"lists", lists_json(group.lists)}});
  }
  return groups;
}

Measured measured_from(const Json& json) {
  Measured measured;
  for (const Json& group : json) {
    measured.groups.push_back({group.at("ground").get<std::string>(),
                               group.at("scenario").get<std::string>(),
                               group.at("command").get<double>(), lists_from(group.at("runs")),
                               lists_from(group.at("lists"))});
  }
  return measured;
}

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  int n = 0;
  for (const double v : values) {
    if (std::isnan(v)) continue;
    sum += v;
    ++n;
  }
  return n > 0 ? sum / n : kNan;
}

double median_of(std::vector<double> values) {
  if (std::ranges::any_of(values, [](double v) { return std::isnan(v); })) return kNan;
  std::ranges::sort(values);
  return quantile(values, 0.5);
}

double least_of(const std::vector<double>& values) {
  double least = kNan;
  for (const double v : values) least = std::fmin(least, v);
  return least;
}

double greatest_of(const std::vector<double>& values) {
  double greatest = kNan;
  for (const double v : values) greatest = std::fmax(greatest, v);
  return greatest;
}

}  // namespace sandrunner::study
