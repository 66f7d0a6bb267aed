// SPDX-License-Identifier: BSD-3-Clause
#include "rt/loop/policy_runner.h"

#include "estimator/observation.h"

namespace sandrunner {

void PolicyRunner::step(const PolicyInput& input) noexcept {
  if (!policy_) return;
  if (newest_.sequence == 0 || newest_.episode != input.episode) policy_->reset();
  const PolicyStep step = policy_->step(make_observation(input));
  newest_.input_tick = input.tick;
  newest_.episode = input.episode;
  ++newest_.sequence;
  newest_.target_rad = step.target_rad;
  newest_.estimate = step.estimate;
}

void PolicyRunner::restore(const PolicyOutput& newest, const NetworkState& network) noexcept {
  newest_ = newest;
  if (policy_) policy_->set_state(network);
}

}  // namespace sandrunner
