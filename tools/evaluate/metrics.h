// SPDX-License-Identifier: BSD-3-Clause
// Which figures of the runs are reported, and the runs of all policies.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "rt/core/command_shaping.h"
#include "tools/evaluate/statistics.h"
#include "tools/evaluate/study.h"
#include "tools/evaluate/trial_figures.h"

namespace sandrunner::evaluate {

/// How the runs of a group are pooled: share of the runs, mean, or root of the mean square.
enum class Pooling { kRate, kMean, kRms };

struct Metric {
  const char* key;      ///< in JSON and CSV, with the unit
  const char* heading;  ///< of a column of the tables
  double table_scale;   ///< from SI to the unit in the heading
  int digits;
  Pooling pooling;
  double (*of_run)(const TrialFigures& run);  ///< nan: this run does not count
};

/// All of them.
const std::vector<Metric>& metrics();
/// The one with this key, which must exist.
const Metric& metric(std::string_view key);

Estimate pool(const Metric& metric, const std::vector<TrialFigures>& runs);

/// A part with what each policy did in it.
struct PartResults {
  Part part;
  /// [policy][group][run].
  std::vector<std::vector<std::vector<TrialFigures>>> runs;
};

/// All that was evaluated.
struct Results {
  std::vector<std::string> policies;       ///< names, made different from each other
  std::vector<CommandEnvelope> envelopes;  ///< of the policies
  std::vector<PartResults> parts;
};

}  // namespace sandrunner::evaluate
