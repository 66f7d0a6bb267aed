// SPDX-License-Identifier: BSD-3-Clause
// Runs trials of a policy on the batch: observation, network and joint targets at 100 Hz, robots at
// 4 kHz in packs.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "policy/policy.h"
#include "sim/robot/robot_model.h"
#include "tools/evaluate/trial.h"
#include "tools/evaluate/trial_figures.h"

namespace sandrunner::evaluate {

struct RunnerSettings {
  int threads = 1;
  bool torque_speed_line = true;
  /// Packs of robots; the results have the same bits at every width.
  sim::BatchWidth width = sim::best_batch_width();
};

/// A robot at the start of a policy step, for those who need more than a run's figures.
struct ObservedStep {
  const sim::RobotState<float>& state;
  const StateEstimate& truth;
  const StateEstimate& estimate;
  const JointArray<double>& torque_nm;  ///< of the drives, under the targets until this step
  const NetworkState& memory;           ///< after the step
};
/// `trial`: its place in the list. Called by several threads, for one trial by one of them.
using StepObserver = std::function<void(std::size_t trial, const ObservedStep& step)>;

/// Figures of each trial, in their order; the same bits for any number of threads. `progress`, if
/// any, is called with the number of trials done so far, by one thread at a time.
std::vector<TrialFigures> run_trials(const sim::Robot& robot, const sim::FootProfile<double>& foot,
                                     const Policy& policy, const std::vector<Trial>& trials,
                                     const RunnerSettings& settings,
                                     const std::function<void(std::size_t done)>& progress = {},
                                     const StepObserver& observe = {});

/// The robot's facts that the figures need. `policy` may limit the torque further.
RobotFacts robot_facts(const sim::Robot& robot, const PolicySpec& policy);

}  // namespace sandrunner::evaluate
