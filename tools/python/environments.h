// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "rt/base/worker_pool.h"
#include "sim/batch/batch.h"
#include "sim/robot/robot_model.h"
#include "tools/python/checks.h"
#include "tools/train/data/rollout.h"
#include "tools/train/task/task.h"

namespace sandrunner::python {

/// How the environments are made; the values are checked by `Environments`.
struct EnvironmentsOptions {
  std::string robot = "raibo";  ///< as sim::load_robot takes it
  int envs = 1024;
  std::uint64_t seed = 1;
  int threads = 1;
  std::string config_file;            ///< TOML, as --config of sandrunner-train; empty: none
  std::vector<std::string> settings;  ///< PATH=VALUE, as --set of sandrunner-train
  bool in_joints = true;              ///< actions of joints; else of the trainer's leg modes
  int width = 0;                      ///< of the batch, 1, 8 or 16; 0: the widest
};

/// How far a training has got, as far as the environments depend on it.
struct Progress {
  train::Curriculum curriculum;
  double transitions = 0.0;
  double late = 0.0;  ///< share of the late penalties, 0 to 1
};

/// The environments of sandrunner-train with the loop of its Training around them: `step` is one
/// step of all, and after every `learner.window` of them the curricula move. Arrays stay where they
/// are for as long as this object lives. Same bits as a training with the same seed and actions,
/// for any number of threads and width of the batch.
class Environments {
 public:
  /// Throws InputError for a robot, count or setting that cannot be used.
  explicit Environments(const EnvironmentsOptions& options);

  /// Begins all episodes anew. The curricula stay.
  void restart(std::uint64_t seed);
  /// One step of 10 ms of all. `actions`: (envs, 12), row-major, finite, in network units.
  void step(const float* actions);

  /// Whether the curricula move as in a training.
  void set_moves(bool moves) { moves_ = moves; }
  Progress progress() const;
  void set_progress(const Progress& progress);

  const train::TaskConfig& config() const { return config_; }
  const sim::Robot& robot() const { return robot_; }
  const train::Task& task() const { return task_; }
  const train::WindowStats& window() const { return stats_; }
  int envs() const { return envs_; }
  int block_envs() const { return block_envs_; }
  int threads() const { return pool_.threads(); }
  int window_steps() const { return window_; }
  const std::string& effective_settings() const { return effective_; }

  /// Of the latest step.
  learner::Rollout& rollout() { return rollout_; }
  train::StepDetails& details() { return details_; }
  std::vector<std::uint8_t>& terminated() { return terminated_; }
  std::vector<std::uint8_t>& truncated() { return truncated_; }
  std::vector<std::uint8_t>& ended() { return ended_; }

  std::atomic<bool>& busy() { return busy_; }

 private:
  struct Settings {
    train::TaskConfig task;
    int block_envs = 0, window = 0;
    std::string effective;
  };
  static Settings read_settings(const EnvironmentsOptions& options, const sim::Robot& robot);
  Environments(const EnvironmentsOptions& options, const sim::Robot& robot);
  Environments(const EnvironmentsOptions& options, const sim::Robot& robot,
               const Settings& settings);

  void observe();
  void step_block(int block, const float* actions);

  sim::Robot robot_;
  train::TaskConfig config_;
  std::string effective_;
  int envs_, block_envs_, window_;
  WorkerPool pool_;
  train::Task task_;
  learner::Rollout rollout_;  // of one step: action(0) leads from observation(0) to observation(1)
  train::StepDetails details_;
  std::vector<std::uint8_t> terminated_, truncated_, ended_;
  train::WindowStats stats_;
  bool moves_ = true;
  double transitions_ = 0.0, late_ = 0.0;
  int steps_ = 0;  // of the present window
  OwnProcess process_;
  std::atomic<bool> busy_ = false;
};

}  // namespace sandrunner::python
