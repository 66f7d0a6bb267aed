// SPDX-License-Identifier: BSD-3-Clause
#include "rt/loop/policy_link.h"

#include "estimator/observation.h"

namespace sandrunner {

void step_policy(Policy& policy, const PolicyInput& input, PolicyOutput& newest) noexcept {
  if (newest.sequence == 0 || newest.episode != input.episode) policy.reset();
  const PolicyStep step = policy.step(make_observation(input));
  newest.input_tick = input.tick;
  newest.episode = input.episode;
  ++newest.sequence;
  newest.target_rad = step.target_rad;
  newest.estimate = step.estimate;
}

void InlinePolicy::release(const PolicyInput& input) noexcept {
  if (policy_) step_policy(*policy_, input, newest_);
}

void InlinePolicy::restore(const PolicyOutput& newest, const NetworkState& network) noexcept {
  newest_ = newest;
  if (policy_) policy_->set_state(network);
}

}  // namespace sandrunner
