// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/experiments/experiments.h"

namespace sandrunner::study {

const std::vector<Experiment>& experiments() {
  static const std::vector<Experiment> kAll = {
      {"fairness", trained_controllers(), run_fairness},
      {"E1",
       {"ours", "env-rigid", "env-quasistatic", "env-linear", "pl-gm", "pl-rigid", "published"},
       run_beach},
      {"E2", {"ours", "published"}, run_recovery},
      {"E3", {"ours", "env-rigid", "published"}, run_grounds},
      {"E4", {"ours", "published"}, run_hidden_state},
      {"E5", {"ours", "env-rigid", "pl-gm", "pl-rigid", "published"}, run_mattress},
      {"E6", {"ours", "env-rigid", "published"}, run_foam},
      {"E7",
       {"ours", "env-rigid", "pl-gm", "pl-rigid", "teacher-gm", "oracle-h", "oracle-o", "tcn"},
       run_grid},
      {"E8", {"oracle-h", "oracle-o"}, run_attribution},
  };
  return kAll;
}

}  // namespace sandrunner::study
