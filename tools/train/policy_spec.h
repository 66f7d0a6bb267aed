// SPDX-License-Identifier: BSD-3-Clause
// What a policy file has to say of a network that was trained in our task: by our trainer, or by
// another with our environments.
#pragma once

#include "policy/policy.h"
#include "sim/robot/robot_model.h"
#include "tools/train/task/normalise.h"
#include "tools/train/task/task.h"

namespace sandrunner::train {

/// All but the provenance. `commands`: the fastest that were drawn.
PolicySpec policy_spec(const TaskConfig& config, const sim::Robot& robot, const InputScales& scales,
                       const CommandRange& commands);

/// The normalisation of observations, so that the network sees what it saw in the task.
void set_normalisation(const InputScales& scales, NetworkParameters& parameters);

}  // namespace sandrunner::train
