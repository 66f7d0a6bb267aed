// SPDX-License-Identifier: BSD-3-Clause
// A simulation that is lost must not reach the weights: one nan in a minibatch is one in all of
// them.
#include "sim/step/divergence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "rt/core/processor.h"
#include "tests/support/not_finite.h"
#include "tools/train/task/robot_settings.h"
#include "tools/train/task/task.h"

namespace sandrunner::train {
namespace {

constexpr int kFewEnvs = 16, kFewSteps = 10, kLostEnv = 5, kLostStep = 3;

struct Outcome {
  learner::Rollout rollout{{kFewEnvs, kFewSteps, Task::privileged_size()}, 1};
  WindowStats window;
};

void set_speed(Task& task, float speed_mps) {
  learner::Checkpoint checkpoint;
  task.save(checkpoint);
  std::vector<sim::BatchRobot<float>> robots(kFewEnvs);
  checkpoint.get("task.robots", robots.data(), robots.size());
  robots[kLostEnv].state.rigid.velocity.x = speed_mps;
  checkpoint.put("task.robots", robots.data(), robots.size());
  task.load(checkpoint);
}

/// Ten steps with the late penalties fully on; before one of them a robot's forward speed is
/// `speed_mps`, if that is not its own (0).
Outcome steps_with(float speed_mps) {
  flush_denormals_to_zero();
  const sim::Robot robot = sim::load_raibo();
  Task task(shipped_task_config(robot), robot, {kFewEnvs, kFewEnvs}, 1);
  task.end_window(1e12, 1.0);
  Outcome outcome;
  task.observe(0, 0, outcome.rollout);
  for (int t = 0; t < kFewSteps; ++t) {
    outcome.rollout.action(t).setZero();
    if (t == kLostStep && speed_mps != 0.0f) set_speed(task, speed_mps);
    task.step(0, t, outcome.rollout);
  }
  outcome.window = task.end_window(1e12, 1.0);
  return outcome;
}

void expect_penalised_as_a_fall(const Outcome& lost) {
  const Outcome other = steps_with(0.0f);
  ASSERT_EQ(other.rollout.end(kLostStep, kLostEnv), learner::End::kNone);
  EXPECT_EQ(lost.rollout.end(kLostStep, kLostEnv), learner::End::kTerminated);
  EXPECT_EQ(lost.rollout.reset(kLostStep + 1, kLostEnv), 1);
  EXPECT_LT(lost.rollout.reward(kLostStep, kLostEnv), 0.0f);
  for (int t = 0; t < kFewSteps; ++t) {
    const auto seen = lost.rollout.observation(t + 1), expected = other.rollout.observation(t + 1);
    EXPECT_TRUE(seen.allFinite()) << t;
    EXPECT_TRUE(lost.rollout.privileged(t + 1).allFinite()) << t;
    for (int env = 0; env < kFewEnvs; ++env) {
      EXPECT_TRUE(std::isfinite(lost.rollout.reward(t, env))) << env << " at " << t;
      if (env == kLostEnv) continue;
      EXPECT_EQ(lost.rollout.reward(t, env), other.rollout.reward(t, env)) << env << " at " << t;
      EXPECT_EQ(seen.col(env), expected.col(env)) << env << " at " << t;
    }
  }
  for (const double mean : {lost.window.reward, lost.window.power_w, lost.window.torque_squared}) {
    EXPECT_LT(std::fabs(mean), 1e4);
  }
}

TEST(DivergenceTest, IsNoneOfARobotFarUpASlope) {
  sim::Shape<float> slope;
  slope.slope_x = 0.4f;
  sim::RigidState<float> x;
  x.position = {40.0f, 0.0f, 16.5f};
  EXPECT_FALSE(sim::diverged(x, slope));
  EXPECT_TRUE(sim::diverged(x, {}));
}

TEST(DivergenceTest, OfARobotThatIsNotANumberIsAFallThatNothingElseFeels) {
  expect_penalised_as_a_fall(steps_with(static_cast<float>(kNan)));
}

TEST(DivergenceTest, OfARobotFasterThanAnyIsAFallThatNothingElseFeels) {
  expect_penalised_as_a_fall(steps_with(1e6f));
}

}  // namespace
}  // namespace sandrunner::train
