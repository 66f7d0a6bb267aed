// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/penalty_gate.h"

#include <algorithm>

namespace sandrunner::train {

PenaltyGate::PenaltyGate(const GateSettings& settings, double tracked_error, double transitions,
                         double settle_share, double wait_transitions)
    : settings_(settings),
      tracked_error_(tracked_error),
      transitions_(transitions),
      settle_transitions_(std::max(transitions * settle_share, 1.0)),
      wait_transitions_(wait_transitions) {}

void PenaltyGate::judge(const BatteryFigures& figures) {
  const bool passed = figures.alive >= settings_.least_alive && figures.error <= tracked_error_;
  state_.passed = passed ? 1.0 : 0.0;
}

void PenaltyGate::advance(double transitions) {
  const double rise = (transitions - state_.transitions) / settings_.rise_transitions;
  state_.transitions = transitions;
  if (!settings_.enabled || state_.passed > 0.0) {
    if (transitions > wait_transitions_) state_.late += rise;
  } else {
    state_.late -= settings_.back_rate * rise;
  }
  state_.late = std::clamp(state_.late, 0.0, 1.0);
}

double PenaltyGate::unsettled() const {
  return std::clamp((transitions_ - state_.transitions) / settle_transitions_, 0.0, 1.0);
}

}  // namespace sandrunner::train
