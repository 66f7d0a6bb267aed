// SPDX-License-Identifier: BSD-3-Clause
// What the nearest neighbours of a state in other runs tell of it: numbers that can fail where a
// picture cannot.
#pragma once

#include <vector>

#include "tools/study/analysis/tsne.h"

namespace sandrunner::study {

/// States of runs on several grounds.
struct States {
  Points points;              ///< a row each
  std::vector<int> run;       ///< of each state
  std::vector<int> ground;    ///< of each run
  std::vector<double> phase;  ///< of each state: of the gait, 0 to 1
};

/// The `count` nearest neighbours of each state among the states of other runs.
std::vector<std::vector<int>> neighbours_in_other_runs(const States& states, int count);

/// Share of the states whose neighbours tell the ground by their majority; of equal numbers, the
/// ground of the nearest one wins. `ground`: of each run.
double share_told(const States& states, const std::vector<std::vector<int>>& neighbours,
                  const std::vector<int>& ground);

/// 95th percentile of that share with the grounds shuffled over the runs, 100 times.
double shuffled_share_told(const States& states, const std::vector<std::vector<int>>& neighbours);

/// Length of the mean of exp(i error), the error being that of the phase that the neighbours tell:
/// 1 if they always tell it, near 0 if they tell nothing.
double phase_told(const States& states, const std::vector<std::vector<int>>& neighbours);

}  // namespace sandrunner::study
