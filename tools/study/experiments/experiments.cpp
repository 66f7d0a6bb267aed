// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/experiments/experiments.h"

#include <algorithm>

#include "tools/study/evidence/grid_evidence.h"
#include "tools/study/experiments/oracles.h"

namespace sandrunner::study {
namespace {

std::vector<const char*> with_published(std::vector<const char*> keys) {
  keys.push_back("published");
  return keys;
}

}  // namespace

const std::vector<Experiment>& experiments() {
  static const std::vector<Experiment> kAll = {
      {"fairness", "Fairness: each controller on the ground of its own training",
       trained_controllers(), run_fairness},
      {"E1", "Dry sand (Table 1, Fig. 2 C to F)", with_published(beach_controllers()), run_beach},
      {"E2", "Recovery and transition (Fig. 2 A, B, movie S1)", {"ours"}, run_recovery},
      {"E3", "Vinyl, track and grass; turns (Fig. 3 D, E)", with_published({"ours", "env-rigid"}),
       run_grounds},
      {"E4", "Hidden state (Fig. 3 F)", {"ours"}, run_hidden_state},
      {"E5", "Air mattress (Fig. 3 G, H)", with_published(mattress_controllers()), run_mattress},
      {"E6", "Memory foam (fig. S8)", {"ours", "env-rigid"}, run_foam},
      {"E7", "Grid of stiffnesses (Fig. 4 A to D, table S1, fig. S10)", grid_controllers(),
       run_grid},
      {"E8", "Attribution (Fig. 4 E to G, figs. S9, S11)", oracle_controllers(), run_attribution},
  };
  return kAll;
}

const Experiment* find_experiment(std::string_view key) {
  const auto& all = experiments();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Experiment& e) { return key == e.key; });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace sandrunner::study
