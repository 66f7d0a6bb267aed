// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tools/train/data/rollout.h"

namespace sandrunner::learner {

/// Generalised advantage estimation (Schulman et al. 2016, eq. 16) for environments first_env ... +
/// envs: fills `advantage` and `value_target` from `reward`, `end`, `timeout_value` and `value` (of
/// steps 0 ... steps).
void compute_gae(Rollout& rollout, int first_env, int envs, double gamma, double lambda);

}  // namespace sandrunner::learner
