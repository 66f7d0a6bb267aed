// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "policy/policy_file.h"
#include "sim/robot/robot_model.h"
#include "tools/train/learner/learner.h"
#include "tools/train/progress.h"
#include "tools/train/task/task.h"
#include "tools/train/train_config.h"

namespace sandrunner::train {

struct TrainingOptions {
  std::string
      out;  ///< folder for checkpoint.bin, policy.safetensors, curve.csv, curve.html, curve.png
  int threads = 1;
  std::uint64_t seed = 1;  ///< of weights and environments
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
  /// InputError if there is none or it belongs to another configuration, seed or robot.
  void start();
  void resume();
  /// Before `start`: the weights of a policy file in place of random ones. Its normalisation and
  /// scales are not taken over, those of the configuration hold; the critic starts at random.
  void go_on_from(PolicyFile policy);

  /// Windows until the transitions are done or somebody interrupts; writes the files now and then
  /// and at the end. A training that was complete stays as it is.
  void run(const std::atomic<bool>& interrupted);

 private:
  void save();
  void restore(const learner::Checkpoint& checkpoint);
  void step_window();
  void settle();
  void fall_back();
  ProgressRow make_row(const WindowStats& window, const learner::UpdateStats& update,
                       double simulation_s, double total_s) const;
  PolicyFile policy_file() const;

  TrainConfig config_;
  sim::Robot robot_;
  TrainingOptions options_;
  WorkerPool pool_;
  Task task_;
  learner::Learner learner_;
  Progress progress_;
  std::string checkpoint_path_;
  std::uint64_t config_hash_, robot_hash_;
  std::string origin_ = "sandrunner-train, from random weights";
  std::string builds_, processors_;  // of this process and those it continues, separated by commas
  double cpu_before_s_ = 0.0;        // core time of those before
  double saved_at_s_ = 0.0;          // wall time of the last checkpoint
  int fallbacks_ = 0;                // since then
};

}  // namespace sandrunner::train
