// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/learner/gae.h"

namespace sandrunner::learner {

void compute_gae(Rollout& rollout, int first_env, int envs, double gamma, double lambda) {
  const auto discount = static_cast<float>(gamma);
  const auto decay = static_cast<float>(gamma * lambda);
  for (int env = first_env; env < first_env + envs; ++env) {
    float advantage = 0.0f;
    for (int t = rollout.shape.steps - 1; t >= 0; --t) {
      float next_value = rollout.value(t + 1, env);
      const End end = rollout.end(t, env);
      if (end != End::kNone) {
        next_value = end == End::kTimeout ? rollout.timeout_value(t, env) : 0.0f;
        advantage = 0.0f;
      }
      const float value = rollout.value(t, env);
      advantage = rollout.reward(t, env) + discount * next_value - value + decay * advantage;
      rollout.advantage(t, env) = advantage;
      rollout.value_target(t, env) = advantage + value;
    }
  }
}

}  // namespace sandrunner::learner
