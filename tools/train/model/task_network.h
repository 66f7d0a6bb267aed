// SPDX-License-Identifier: BSD-3-Clause
// The networks of a file as a Task runs them.
#pragma once

#include <array>
#include <vector>

#include "policy/policy_file.h"
#include "tools/train/learner/parameters.h"
#include "tools/train/task/normalise.h"
#include "tools/train/task/task_config.h"

namespace sandrunner::train {

/// How observations enter: (x - mean) / sqrt(variance + 1e-8), limited to +-clip.
struct ObservationScales {
  std::vector<float> mean, variance;
  float clip = 0.0f;
};
ObservationScales scales_of(const NetworkParameters& parameters);

/// The layout of networks of a file, whose tensors have the same places as in that of a training;
/// the critic is a single layer that is not used.
learner::ParameterLayout model_layout(const Wiring& wiring);

/// A network as a Task runs it: it answers in modes.
struct TaskNetwork {
  PolicySpec spec;
  ObservationScales scales;
  learner::ParameterLayout layout;
  std::vector<float> parameters;
};

/// `mode_gain`: of the Task (leg_modes.h).
TaskNetwork make_task_network(PolicyFile file, const std::array<double, kNumLegs>& mode_gain);

/// Throws InputError unless weights of `network`, of a policy with this spec, mean in a Task with
/// these settings and scales what they mean in their own. Nominal positions may differ: angles are
/// shown as what they are off them.
void require_scales(const PolicySpec& spec, const ObservationScales& network,
                    const PolicySettings& task, const InputScales& task_scales);

}  // namespace sandrunner::train
