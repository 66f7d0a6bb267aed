// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/simulated/task_run.h"

#include <cstddef>

namespace sandrunner::study {
namespace {

constexpr double kTrainingDone_transitions = 1e12;  // beyond the end of any schedule

}  // namespace

void run_on_task(const train::TaskNetwork& network, const TaskRun& run, const sim::Robot& robot,
                 WorkerPool& pool, const TaskObserver& observe) {
  train::Task task(run.task, robot, {run.envs, run.block_envs}, run.seed);
  task.set_curriculum({run.task.command.speed_max_mps, 1.0}, kTrainingDone_transitions, 1.0);
  task.restart(run.seed);  // draws again, with the curricula open
  train::StepDetails details(run.envs);
  task.watch(&details);
  learner::Rollout rollout({run.envs, 1, train::Task::privileged_size(), kInsightSize, 0},
                           network.layout.memory());
  learner::Weights<float> weights(network.layout);
  weights.set(network.parameters.data());
  std::vector<learner::BlockPass<float>> passes;
  for (int worker = 0; worker < pool.threads(); ++worker) {
    passes.emplace_back(network.layout, 1, run.block_envs, 1);
  }
  learner::Matrix<float> memory = learner::Matrix<float>::Zero(network.layout.memory(), run.envs);
  const auto run_block = [&](int block, int worker) {
    const int envs = run.block_envs, first = block * envs;
    for (int env = first; env < first + envs; ++env) {
      if (!run.trials.empty()) task.begin_trial(env, run.trials[static_cast<std::size_t>(env)]);
      rollout.reset(0, env) = 1;
    }
    task.observe(block, 0, rollout);
    learner::BlockPass<float>& pass = passes[static_cast<std::size_t>(worker)];
    for (int step = 0; step < run.steps; ++step) {
      pass.answer(weights, rollout.observation(0).middleCols(first, envs),
                  rollout.insight(0).middleCols(first, envs), &rollout.reset(0, first),
                  memory.middleCols(first, envs), rollout.action(0).middleCols(first, envs));
      task.step(block, 0, rollout);
      observe({step, first, envs, rollout, pass.actor_input(), pass.encoding(), details, task});
      rollout.begin_next(first, envs);
    }
  };
  pool.run(run.envs / run.block_envs, run_block);
}

}  // namespace sandrunner::study
