// SPDX-License-Identifier: BSD-3-Clause
#include "rt/loop/lockstep.h"

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

void Lockstep::tick(const OperatorCommand& command) noexcept {
  io_.read(input_.sensors);
  input_.policy = newest_;
  input_.command = command;
  controller_.step(input_, output_);
  io_.write(output_.command);
  // The controller decides from which tick on the answer counts (latency_ticks).
  if (policy_ran()) step_policy(*policy_, output_.policy_input, newest_);
}

LockstepState Lockstep::state() const noexcept {
  LockstepState s;
  s.policy_output = newest_;
  s.controller = controller_.state();
  if (policy_) s.network = policy_->state();
  return s;
}

void Lockstep::restore(const LockstepState& state) noexcept {
  newest_ = state.policy_output;
  controller_.restore(state.controller);
  if (policy_) policy_->set_state(state.network);
}

void Lockstep::add_to(StateHash& hash) const noexcept { hash.add(state()); }

}  // namespace sandrunner
