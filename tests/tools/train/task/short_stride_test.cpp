// SPDX-License-Identifier: BSD-3-Clause
// Strides as the reward sees them: from touchdown to touchdown of a foot.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "rt/core/processor.h"
#include "tools/train/task/robot_settings.h"
#include "tools/train/task/task.h"

namespace sandrunner::train {
namespace {

constexpr int kMarching = 16, kMarch_steps = 120, kStride_steps = 20;
constexpr int kTrot = 3 * kJointsPerLeg;  // the mode's first output
constexpr float kLift = 0.8f;             // network units

/// Penalty on short strides in a step, the mean of robots that lift diagonal pairs of feet
/// alternately on hard ground every 0.2 s.
double penalty_on(double shortest_s) {
  flush_denormals_to_zero();
  const sim::Robot robot = sim::load_raibo();
  TaskConfig config = shipped_task_config(robot);
  config.episode.reset_nominal_share = 1.0;
  config.episode.push_probability = 0.0;
  config.ground.patchy_envs = 0;
  config.ground.rigid_envs = kMarching;
  penalty::ShortStride& stride = config.reward.penalties;
  stride.weight = 1.0;
  stride.shortest_s = shortest_s;
  config.reward.penalty.weight = config.reward.penalty.late_factor = 1.0;
  Task task(config, robot, {kMarching, kMarching}, 1);
  task.end_window(1e12, 1.0);  // late penalties fully on
  learner::Rollout rollout{{kMarching, kMarch_steps, Task::privileged_size()}, 1};
  task.observe(0, 0, rollout);
  for (int t = 0; t < kMarch_steps; ++t) {
    const float lift = t / (kStride_steps / 2) % 2 == 0 ? kLift : -kLift;
    auto modes = rollout.action(t);
    modes.setZero();
    modes.row(kTrot + 1).setConstant(lift);          // HFE
    modes.row(kTrot + 2).setConstant(-2.0f * lift);  // KFE
    task.step(0, t, rollout);
  }
  const WindowStats w = task.end_window(1e12, 1.0);
  EXPECT_EQ(w.falls[0], 0.0);
  const std::vector<std::string> names = reward_term_names();
  const auto term = std::ranges::find(names, "penalty_short_stride");
  return -w.terms[static_cast<std::size_t>(term - names.begin())];
}

TEST(ShortStride, IsPenalisedByTheTimeFromTouchdownToTouchdownThatItLacks) {
  // All but the first touchdown of each foot.
  constexpr int kTouchdowns = kMarch_steps / kStride_steps;
  constexpr double kStrides = kNumLegs * (kTouchdowns - 1);
  EXPECT_NEAR(penalty_on(0.3), kStrides * 0.1 / kMarch_steps, 0.1 * kStrides * 0.1 / kMarch_steps);
  EXPECT_NEAR(penalty_on(0.4), kStrides * 0.2 / kMarch_steps, 0.1 * kStrides * 0.2 / kMarch_steps);
}

TEST(ShortStride, LongEnoughOnesAreFree) { EXPECT_LT(penalty_on(0.18), 0.05 * penalty_on(0.3)); }

}  // namespace
}  // namespace sandrunner::train
