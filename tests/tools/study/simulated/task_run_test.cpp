// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/simulated/task_run.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "policy/policy_file.h"
#include "tools/train/task/robot_settings.h"

namespace sandrunner::study {
namespace {

class TaskRunTest : public testing::Test {
 protected:
  TaskRunTest() { task_.ground.rigid_envs = task_.ground.patchy_envs = 0; }
  /// Reward of each environment over the run.
  std::vector<double> rewards(const TaskRun& run, int threads) const {
    std::vector<double> sums(static_cast<std::size_t>(run.envs));
    WorkerPool pool(threads);
    run_on_task(network_, run, robot_, pool, [&](const TaskStep& s) {
      for (int env = s.first_env; env < s.first_env + s.envs; ++env) {
        sums[static_cast<std::size_t>(env)] += s.rollout.reward(0, env);
      }
    });
    return sums;
  }

  const sim::Robot robot_ = sim::load_raibo();
  train::TaskConfig task_ = train::shipped_task_config(robot_);
  const train::TaskNetwork network_ = train::make_task_network(
      parse_policy_file(shipped_policy_text(), "the shipped policy"), task_.policy.mode_gain);
};

TEST_F(TaskRunTest, HasTheSameBitsForAnyThreadsAndOthersForAnotherSeed) {
  TaskRun run{task_, 32};
  run.steps = 20;
  const std::vector<double> one = rewards(run, 1);
  EXPECT_EQ(rewards(run, 2), one);
  run.seed = 2;
  EXPECT_NE(rewards(run, 1), one);
}

TEST_F(TaskRunTest, ShowsEachStepAsTheNetworkAnsweredIt) {
  TaskRun run{task_};
  run.steps = 3;
  WorkerPool pool(1);
  int steps = 0;
  run_on_task(network_, run, robot_, pool, [&](const TaskStep& s) {
    EXPECT_EQ(s.step, steps++);
    ASSERT_EQ(s.actor_input.rows(), network_.layout.actor_inputs());
    for (int env = 0; env < s.envs; ++env) {
      for (int i = 0; i < kCommandSize; ++i) {
        EXPECT_EQ(s.actor_input(i, env), s.rollout.observation(0)(i, env));
      }
      for (int i = 0; i < network_.layout.hidden(); ++i) {
        EXPECT_EQ(s.actor_input(kCommandSize + i, env), s.encoding(i, env));
      }
      // The insight holds the state that the estimator is to find.
      for (int i = 0; i < kEstimateSize; ++i) {
        EXPECT_EQ(s.rollout.insight(0)(kTerrainSize + i, env),
                  s.rollout.estimate_target(0)(i, env));
      }
    }
  });
  EXPECT_EQ(steps, 3);
}

TEST_F(TaskRunTest, GivesTrialsTheirCommandAndGround) {
  TaskRun run{task_};
  run.steps = 2;
  train::Trial trial;
  const train::Task other(task_, robot_, {16, 16}, 5);
  const sim::Terrain<float> terrain = other.terrain(0);
  trial.terrain = &terrain;
  trial.command = {1.0f, 0.0f, 0.0f};
  trial.features[0] = 0.25f;
  run.trials.assign(16, trial);
  WorkerPool pool(1);
  run_on_task(network_, run, robot_, pool, [&](const TaskStep& s) {
    EXPECT_EQ(s.rollout.insight(0)(0, 7), 0.25f);
    EXPECT_EQ(s.task.terrain(7).ground[0].sigma_flat, terrain.ground[0].sigma_flat);
    // From rest, with 2 m/s^2.
    EXPECT_NEAR(s.task.command(7)[0], 0.02 * (s.step + 1), 1e-6);
  });
}

}  // namespace
}  // namespace sandrunner::study
