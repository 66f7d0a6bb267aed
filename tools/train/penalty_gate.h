// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tools/train/battery.h"
#include "tools/train/data/checkpoint.h"

namespace sandrunner::train {

/// Table `gate` of tools/train/training.toml.
struct GateSettings {
  bool enabled = false;           ///< off: as if every battery were passed
  double least_alive = 0.0;       ///< share of the battery's runs that a policy must survive
  double rise_transitions = 0.0;  ///< in which the late penalties rise, if never stopped
  double back_rate = 0.0;         ///< at which they go back, in units of that at which they rise
};

/// The late penalties wait for performance: their share rises while the latest battery was survived
/// and tracked, and stays or goes back while it was not.
class PenaltyGate {
 public:
  /// A training of `transitions`, the last `settle_share` of which it settles. `tracked_error`:
  /// BatterySettings. Nothing rises in the first `wait_transitions`.
  PenaltyGate(const GateSettings& settings, double tracked_error, double transitions,
              double settle_share, double wait_transitions);

  /// The latest battery's result, which holds until the next.
  void judge(const BatteryFigures& figures);
  /// Moves on to this many transitions since the start of the training.
  void advance(double transitions);

  /// 0 to 1: how much of what comes late in a training is on.
  double late() const { return state_.late; }
  /// 1 to 0: how much of the settling is still to come.
  double unsettled() const;

  void save(learner::Checkpoint& checkpoint) const { checkpoint.put("gate", &state_, 1); }
  void load(const learner::Checkpoint& checkpoint) { checkpoint.get("gate", &state_, 1); }

 private:
  struct State {
    double transitions = 0.0;
    double late = 0.0;
    double passed = 0.0;  // 1: the latest battery
  };

  GateSettings settings_;
  double tracked_error_, transitions_, settle_transitions_, wait_transitions_;
  State state_;
};

}  // namespace sandrunner::train
