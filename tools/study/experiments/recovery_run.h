// SPDX-License-Identifier: BSD-3-Clause
// Fig. 2 A and B, movie S1: one run in the full simulator whose left front foot meets loose sand.
#pragma once

#include <optional>
#include <string>

#include "rt/report/run_record.h"
#include "tools/study/experiments/lab.h"
#include "tools/study/experiments/runs.h"

namespace sandrunner::study {

struct RecoveryRun {
  RunRecord record;
  double met_s = 0.0;  ///< when the foot touches down on the strip
  int seed = 0;        ///< of the start
};

/// At 2.5 m/s over a strip of half the stiffness from 5.0 to 5.3 m: the first of the starts 0 to 15
/// in which the left front foot alone of the front feet stands on the strip. Nothing: there is
/// none.
/// `model`: a policy file.
std::optional<RecoveryRun> find_recovery_run(const Lab& lab, const Model& model);

/// Speed, tilt and feet around it: lists over "t_s" from the touchdown, with their units.
Json recovery_curves(const RecoveryRun& run);
/// The run in 3D, as a page of its own.
std::string recovery_page(RecoveryRun run);

}  // namespace sandrunner::study
