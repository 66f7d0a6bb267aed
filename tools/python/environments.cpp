// SPDX-License-Identifier: BSD-3-Clause
#include "tools/python/environments.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/train/task/robot_settings.h"
#include "tools/train/train_config.h"

namespace sandrunner::python {
namespace {

sim::BatchWidth checked_width(int width) {
  if (width == 0) return sim::best_batch_width();
  if (width != 1 && width != 8 && width != 16) {
    throw InputError(
        fmt::format("width: found {}, expected 1, 8 or 16, or 0 for the widest", width));
  }
  if (width > static_cast<int>(sim::best_batch_width())) {
    throw InputError("width: found 16, expected 1 or 8: this processor has no AVX-512");
  }
  return static_cast<sim::BatchWidth>(width);
}

}  // namespace

Environments::Settings Environments::read_settings(const EnvironmentsOptions& options,
                                                   const sim::Robot& robot) {
  checked("num_envs", options.envs, 1, kMostRobots);
  checked("threads", options.threads, 1, kMostThreads);
  ConfigTree tree;
  train::add_training_layers(tree, robot);
  if (!options.config_file.empty()) tree.add_file(options.config_file);
  for (const std::string& setting : options.settings) tree.set(setting, "settings");
  const auto block_envs = tree.integer("learner.block_envs", 64, 1, 1 << 16);
  if (options.envs % block_envs != 0) {
    throw InputError(
        fmt::format("num_envs: found {}, expected a multiple of learner.block_envs, which is {}",
                    options.envs, block_envs));
  }
  tree.set(fmt::format("run.envs={}", options.envs));
  const train::TrainConfig all = train::read_train_config(tree);
  check_robot(all.task, robot);
  Settings settings{all.task, all.learner.block_envs, all.window, all.effective};
  settings.task.policy.in_joints = options.in_joints;
  return settings;
}

Environments::Environments(const EnvironmentsOptions& options)
    : Environments(options, sim::load_robot(options.robot)) {}

Environments::Environments(const EnvironmentsOptions& options, const sim::Robot& robot)
    : Environments(options, robot, read_settings(options, robot)) {}

Environments::Environments(const EnvironmentsOptions& options, const sim::Robot& robot,
                           const Settings& settings)
    : robot_(robot),
      config_(settings.task),
      effective_(settings.effective),
      envs_(options.envs),
      block_envs_(settings.block_envs),
      window_(settings.window),
      pool_(options.threads),
      task_(config_, robot_, {envs_, block_envs_, checked_width(options.width)}, options.seed),
      rollout_({.envs = envs_, .steps = 1, .privileged = train::Task::privileged_size()}, 1),
      details_(envs_),
      terminated_(static_cast<std::size_t>(envs_)),
      truncated_(terminated_),
      ended_(terminated_) {
  task_.watch(&details_);
  observe();
}

// The first observations, before which memories are clear.
void Environments::observe() {
  for (int env = 0; env < envs_; ++env) rollout_.reset(1, env) = 1;
  pool_.run(envs_ / block_envs_, [&](int block, int) { task_.observe(block, 1, rollout_); });
}

void Environments::restart(std::uint64_t seed) {
  process_.require("VectorEnv");
  task_.restart(seed);
  steps_ = 0;
  std::ranges::fill(terminated_, std::uint8_t{0});
  std::ranges::fill(truncated_, std::uint8_t{0});
  std::ranges::fill(ended_, std::uint8_t{0});
  for (int env = 0; env < envs_; ++env) rollout_.reward(0, env) = 0.0f;
  observe();
}

void Environments::step(const float* actions) {
  process_.require("VectorEnv");
  const auto count = static_cast<std::size_t>(envs_) * kNumJoints;
  const float* const bad =
      std::find_if_not(actions, actions + count, [](float a) { return std::isfinite(a); });
  if (bad != actions + count) {
    const auto at = bad - actions;
    throw InputError(fmt::format("actions: found {} at [{}, {}], expected finite numbers", *bad,
                                 at / kNumJoints, at % kNumJoints));
  }
  pool_.run(envs_ / block_envs_, [&](int block, int) { step_block(block, actions); });
  if (moves_) transitions_ += envs_;
  if (++steps_ < window_) return;
  steps_ = 0;
  const Progress before = progress();
  stats_ = task_.end_window(transitions_, late_);
  if (!moves_) set_progress(before);
}

void Environments::step_block(int block, const float* actions) {
  const int first = block * block_envs_;
  const auto from = static_cast<std::size_t>(first) * kNumJoints;
  const auto count = static_cast<std::size_t>(block_envs_) * kNumJoints;
  std::copy_n(actions + from, count, rollout_.action(0).col(first).data());
  task_.step(block, 0, rollout_);
  for (int env = first; env < first + block_envs_; ++env) {
    const auto e = static_cast<std::size_t>(env);
    const learner::End end = rollout_.end(0, env);
    terminated_[e] = end == learner::End::kTerminated;
    truncated_[e] = end == learner::End::kTimeout;
    ended_[e] = end != learner::End::kNone;
  }
}

Progress Environments::progress() const { return {task_.curriculum(), transitions_, late_}; }

void Environments::set_progress(const Progress& progress) {
  transitions_ = progress.transitions;
  late_ = progress.late;
  task_.set_curriculum(progress.curriculum, transitions_, late_);
}

}  // namespace sandrunner::python
