// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "policy/policy_file.h"
#include "sim/robot/robot_model.h"
#include "tools/train/battery.h"
#include "tools/train/learner/learner.h"
#include "tools/train/model/task_network.h"
#include "tools/train/penalty_gate.h"
#include "tools/train/progress.h"
#include "tools/train/task/task.h"
#include "tools/train/train_config.h"

namespace sandrunner::train {

struct TrainingOptions {
  std::string out;  ///< folder for checkpoint.bin, policies, curve.csv, curve.html
  int threads = 1;
  std::uint64_t seed = 1;  ///< of weights and environments
  learner::Ranks ranks;    ///< that share the work; the first one writes the files
};

/// When a policy was taken from a training, and what was measured of it.
struct Snapshot {
  double transitions = 0.0, core_hours = 0.0;
  double command_speed_mps = 0.0;  ///< fastest command that was drawn
  BatteryFigures battery;
};

/// One training: task, learner, learning curve, and the files in which they are kept.
class Training {
 public:
  Training(const TrainConfig& config, const sim::Robot& robot, const TrainingOptions& options);

  /// Where a training keeps its state.
  static std::string checkpoint_path(const std::string& folder) {
    return folder + "/checkpoint.bin";
  }

  /// Either of these comes before `run`. `resume` reads the checkpoint of the folder; throws
  /// InputError if there is none or it belongs to another configuration, seed or robot. A larger
  /// `run.transitions` is allowed: what follows the length of a training, as settling does, follows
  /// the new length from there on.
  void start();
  void resume();
  /// Before `start`: the weights of a policy file in place of random ones. Its normalisation and
  /// scales are not taken over, those of the configuration hold; the critic starts at random.
  void go_on_from(PolicyFile policy);

  /// Windows until the transitions are done or a signal interrupts; writes the files now and then
  /// and at the end. A training that was complete stays as it is.
  void run(const std::atomic<bool>& interrupted);

  /// What came of it, in one line; empty without a battery.
  std::string verdict() const;

 private:
  void imitate(const std::string& teacher_file);
  double core_seconds() const;
  void require_same_state() const;
  void save();
  void restore(const learner::Checkpoint& checkpoint);
  void require_same_settings(const learner::Checkpoint& checkpoint) const;
  void step_window();
  void settle();
  void run_battery();
  double score(const BatteryFigures& figures) const;
  Snapshot snapshot() const;
  void fall_back();
  ProgressRow make_row(const WindowStats& window, const learner::UpdateStats& update,
                       double simulation_s, double total_s) const;
  PolicySpec policy_spec(const Snapshot& snapshot) const;
  PolicyFile policy_file(PolicySpec spec, const std::vector<float>& parameters) const;

  TrainConfig config_;
  sim::Robot robot_;
  TrainingOptions options_;
  const learner::Ranks& ranks_ = options_.ranks;
  WorkerPool pool_;
  Task task_;
  learner::Learner learner_;
  PenaltyGate gate_;
  std::optional<Battery> battery_;
  BatteryFigures figures_;  // of the latest battery
  Snapshot best_;           // with transitions 0: none yet
  std::vector<float> best_parameters_;
  bool best_is_written_ = true;
  Progress progress_;
  std::string checkpoint_path_;
  std::uint64_t config_hash_, robot_hash_;
  std::string origin_ = "sandrunner-train, from random weights";
  std::string builds_, processors_;  // of this process and those it continues, separated by commas
  double cpu_before_s_ = 0.0;        // core time of those before
  double battery_cpu_s_ = 0.0;       // core time of this process in the battery
  double saved_at_s_ = 0.0;          // wall time of the last checkpoint
  int fallbacks_ = 0;                // since then
};

}  // namespace sandrunner::train
