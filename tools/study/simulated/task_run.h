// SPDX-License-Identifier: BSD-3-Clause
// A trained network on the training's own environments: reward, commands, noise and what an oracle
// sees of the ground are those of a training by construction.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "rt/base/worker_pool.h"
#include "tools/train/learner/block_pass.h"
#include "tools/train/model/task_network.h"
#include "tools/train/task/task.h"

namespace sandrunner::study {

/// Robots of one Task. The curricula are open as far as the settings allow, and all penalties have
/// their final weight.
struct TaskRun {
  train::TaskConfig task;
  int envs = 16;        ///< a multiple of `block_envs`
  int block_envs = 16;  ///< a multiple of 16; the task's settings count environments of a block
  int steps = 400;      ///< of 10 ms
  std::uint64_t seed = 1;
  /// The episode of each environment; empty: the task draws command, ground and start.
  std::vector<train::Trial> trials = {};
};

/// A step of a block of environments, once it is done.
struct TaskStep {
  int step = 0, first_env = 0, envs = 0;
  /// Of all environments. observation(0), insight(0) and estimate_target(0) are what the step began
  /// with, action(0) is the network's answer, in modes (leg_modes.h); reward(0) and end(0) are what
  /// came of it. reset(0): the network's memory was cleared before the step.
  const learner::Rollout& rollout;
  /// Of the block, an environment a column: what the actor saw (BlockPass::actor_input), and the
  /// encoding.
  learner::ConstMatrixRef<float> actor_input, encoding;
  const train::StepDetails& details;  ///< of all environments
  const train::Task& task;            ///< after the step
};
/// Called by several threads, with one block by one of them.
using TaskObserver = std::function<void(const TaskStep& step)>;

/// Runs the network with its mean actions and shows each step of each block; the same bits for any
/// number of threads. A robot that falls starts anew, as in a training.
void run_on_task(const train::TaskNetwork& network, const TaskRun& run, const sim::Robot& robot,
                 WorkerPool& pool, const TaskObserver& observe);

}  // namespace sandrunner::study
