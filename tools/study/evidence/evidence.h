// SPDX-License-Identifier: BSD-3-Clause
// All that was measured, and the figures that tables and claims take from it.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/study/evidence/rules.h"
#include "tools/study/evidence/runs.h"

namespace sandrunner::study {

/// The numbers of `sandrunner-bench contact --json FILE` that claims need.
struct ContactBench {
  double ratio = 0.0;  ///< time of DRFT in space over ours
  /// Range of the quartiles of the final depths over their median.
  double spread_cone = 0.0, spread_drft = 0.0, spread_planar = 0.0;
  std::string processor, cone_mm, drft_mm, planar_mm;
};

struct Evidence {
  /// [experiment][controller][seed].
  std::map<std::string, std::map<std::string, std::map<int, Measured>>> measured;
  std::optional<ContactBench> contact;

  /// The seeds of a controller in an experiment; null: it was not run.
  const std::map<int, Measured>* find(const std::string& experiment,
                                      const std::string& controller) const;
  /// A figure of a controller that was run: `of` is applied to each seed's measurement.
  Figure figure(const std::string& experiment, const std::string& controller,
                const std::function<SeedValue(const Measured&)>& of) const;
};

// What figures are made of. `groups`: runs with the same places.

/// Mean over all runs of all groups; each run's mean over the groups.
SeedValue mean_value(const std::vector<const RunGroup*>& groups, const std::string& name);
/// The same over the successful runs alone.
SeedValue mean_of_successes(const std::vector<const RunGroup*>& groups, const std::string& name);
/// The greatest value of successful runs over all groups, of runs 0 to 4 alone; each run's
/// greatest.
SeedValue greatest_of_first_five(const std::vector<const RunGroup*>& groups,
                                 const std::string& name);

/// The groups with a command from `low` to `high`.
std::vector<const RunGroup*> between(const std::vector<const RunGroup*>& groups, double low,
                                     double high);
/// The one whose successful runs have the mean speed nearest to `speed_mps`; null: none has any.
const RunGroup* nearest_to(const std::vector<const RunGroup*>& groups, double speed_mps);
/// Number of successful runs.
int successes(const RunGroup& group);

/// Whether a controller survives at least 15 of 16 runs at each of 1, 2 and 3 m/s on the ground of
/// its own training; for several seeds their median counts. It must have been run.
bool is_competent(const Evidence& evidence, const std::string& controller);

}  // namespace sandrunner::study
