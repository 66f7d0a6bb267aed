// SPDX-License-Identifier: BSD-3-Clause
// A foot alone that finds the ground softer than the other feet do.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "rt/core/processor.h"
#include "tools/train/task/robot_settings.h"
#include "tools/train/task/task.h"

namespace sandrunner::train {
namespace {

constexpr int kStanding = 16, kSettled = 50;

/// Robots of which a foot stands on another patch than the others after half a second, where all
/// that a robot reaches is one patch.
int robots_in_two_patches(double loose_step_share, double patch_rigid_share) {
  flush_denormals_to_zero();
  const sim::Robot robot = sim::load_raibo();
  TaskConfig config = shipped_task_config(robot);
  config.episode.reset_nominal_share = 1.0;
  config.episode.push_probability = 0.0;
  config.ground.patchy_envs = kStanding;
  config.ground.rigid_envs = 0;
  config.ground.patch_length_low_m = config.ground.patch_length_high_m = 1e3;
  config.ground.patch_rigid_share = patch_rigid_share;
  config.ground.loose_step_share = loose_step_share;
  Task task(config, robot, {kStanding, kStanding}, 1);
  learner::Rollout rollout{{kStanding, kSettled, Task::privileged_size()}, 1};
  task.observe(0, 0, rollout);
  for (int t = 0; t < kSettled; ++t) {
    rollout.action(t).setZero();
    task.step(0, t, rollout);
  }
  int count = 0;
  for (int env = 0; env < kStanding; ++env) {
    const auto feet = task.batch().robot(env).state.feet;
    count +=
        std::ranges::any_of(feet, [&](const auto& foot) { return foot.region != feet[0].region; });
  }
  return count;
}

TEST(LooseStep, PutsAFootOnTheGroundOfASofterPatch) {
  EXPECT_GE(robots_in_two_patches(1.0, 0.5), 8);
}

TEST(LooseStep, IsNoneWithoutItsShare) { EXPECT_EQ(robots_in_two_patches(0.0, 0.5), 0); }

TEST(LooseStep, IsNoneWhereNoPatchIsSofter) { EXPECT_EQ(robots_in_two_patches(1.0, 1.0), 0); }

}  // namespace
}  // namespace sandrunner::train
