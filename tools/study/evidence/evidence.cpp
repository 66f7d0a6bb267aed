// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/evidence/evidence.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace sandrunner::study {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// A figure's values in each run, those of runs without a success being nan if asked for.
std::vector<double> values_of(const RunGroup& group, const std::string& name,
                              bool successes_alone) {
  std::vector<double> values = group.values(name);
  if (successes_alone) {
    const std::vector<double>& success = group.values("success");
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (success[i] != 1.0) values[i] = kNan;
    }
  }
  return values;
}

SeedValue mean_over(const std::vector<const RunGroup*>& groups, const std::string& name,
                    bool successes_alone) {
  std::vector<double> all;
  std::vector<std::vector<double>> by_run;
  for (const RunGroup* group : groups) {
    const std::vector<double> values = values_of(*group, name, successes_alone);
    all.insert(all.end(), values.begin(), values.end());
    by_run.resize(std::max(by_run.size(), values.size()));
    for (std::size_t i = 0; i < values.size(); ++i) by_run[i].push_back(values[i]);
  }
  SeedValue value{mean_of(all)};
  for (const auto& values : by_run) value.runs.push_back(mean_of(values));
  return value;
}

}  // namespace

const std::map<int, Measured>* Evidence::find(const std::string& experiment,
                                              const std::string& controller) const {
  const auto by_controller = measured.find(experiment);
  if (by_controller == measured.end()) return nullptr;
  const auto by_seed = by_controller->second.find(controller);
  if (by_seed == by_controller->second.end() || by_seed->second.empty()) return nullptr;
  return &by_seed->second;
}

Figure Evidence::figure(const std::string& experiment, const std::string& controller,
                        const std::function<SeedValue(const Measured&)>& of) const {
  Figure figure;
  if (const auto* seeds = find(experiment, controller)) {
    for (const auto& [seed, one] : *seeds) figure[seed] = of(one);
  }
  return figure;
}

SeedValue mean_value(const std::vector<const RunGroup*>& groups, const std::string& name) {
  return mean_over(groups, name, false);
}

SeedValue mean_of_successes(const std::vector<const RunGroup*>& groups, const std::string& name) {
  return mean_over(groups, name, true);
}

SeedValue greatest_of_first_five(const std::vector<const RunGroup*>& groups,
                                 const std::string& name) {
  constexpr std::size_t kPaperRuns = 5;
  SeedValue value{kNan};
  for (const RunGroup* group : groups) {
    const std::vector<double> values = values_of(*group, name, true);
    value.runs.resize(std::max(value.runs.size(), values.size()), kNan);
    for (std::size_t i = 0; i < values.size(); ++i) {
      value.runs[i] = std::fmax(value.runs[i], values[i]);
    }
  }
  for (std::size_t i = 0; i < std::min(value.runs.size(), kPaperRuns); ++i) {
    value.value = std::fmax(value.value, value.runs[i]);
  }
  return value;
}

std::vector<const RunGroup*> between(const std::vector<const RunGroup*>& groups, double low,
                                     double high) {
  std::vector<const RunGroup*> found;
  for (const RunGroup* group : groups) {
    if (group->command >= low && group->command <= high) found.push_back(group);
  }
  return found;
}

const RunGroup* nearest_to(const std::vector<const RunGroup*>& groups, double speed_mps) {
  const RunGroup* nearest = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const RunGroup* group : groups) {
    const double off = std::fabs(mean_of_successes({group}, "speed_mps").value - speed_mps);
    if (off < least) {  // not for nan
      least = off;
      nearest = group;
    }
  }
  return nearest;
}

int successes(const RunGroup& group) {
  const std::vector<double>& success = group.values("success");
  return static_cast<int>(std::count(success.begin(), success.end(), 1.0));
}

bool is_competent(const Evidence& evidence, const std::string& controller) {
  constexpr double kLeastAlive = 15.0 / 16.0;
  for (const double command : {1.0, 2.0, 3.0}) {
    const Figure alive = evidence.figure("fairness", controller, [&](const Measured& m) {
      return mean_value(between(m.select("own"), command, command), "alive");
    });
    if (!(median(alive) >= kLeastAlive)) return false;
  }
  return true;
}

}  // namespace sandrunner::study
