// SPDX-License-Identifier: BSD-3-Clause
// What the policy that ships must be able to do, through the whole control process. Bounds are what
// it is good for with a margin, not what it reached once.
#include <gtest/gtest.h>

#include "tests/rt/support.h"

namespace sandrunner {
namespace {

RunResult run(const std::string& terrain, const std::string& command, const RunPlan& plan,
              const std::vector<std::string>& assignments = {}) {
  Policy policy = load_shipped_policy();
  const ProcessConfig config = config_of(terrain, assignments, &policy.spec());
  return simulate({.config = config, .policy = &policy, .command = command, .plan = plan});
}

TEST(ShippedPolicyTest, KeepsTheCommandedSpeedOnSandAndHardGround) {
  for (const char* terrain : {"dry-sand", "grass", "rigid"}) {
    const RunResult slow = run(terrain, "1,0,0", {.walk_s = 8.0, .start_walking = true});
    EXPECT_TRUE(slow.survived) << terrain << ": " << slow.fall_reason;
    EXPECT_NEAR(slow.figures.motion->mean_velocity_mps[0], 1.0, 0.1) << terrain;
    const RunResult fast = run(terrain, "2,0,0", {.walk_s = 8.0, .start_walking = true});
    EXPECT_TRUE(fast.survived) << terrain << ": " << fast.fall_reason;
    EXPECT_NEAR(fast.figures.motion->mean_velocity_mps[0], 2.0, 0.2) << terrain;
    EXPECT_LT(fast.figures.estimate->velocity_rmse_mps, 0.15) << terrain;
  }
}

TEST(ShippedPolicyTest, StandsUpWalksAndStandsAgainOnDrySand) {
  const RunResult result = run("dry-sand", "1.5,0,0", {.walk_s = 8.0});
  EXPECT_TRUE(result.survived) << result.fall_reason;
  EXPECT_EQ(result.walked_s, 8.0);
  EXPECT_GT(result.figures.motion->mean_velocity_mps[0], 1.35);
}

TEST(ShippedPolicyTest, TurnsInPlaceAndStandsStill) {
  const RunResult turn = run("dry-sand", "0,0,0.7", {.walk_s = 8.0, .start_walking = true});
  EXPECT_TRUE(turn.survived) << turn.fall_reason;
  EXPECT_GT(turn.figures.motion->mean_yaw_rate_radps, 0.6);
  const RunResult still = run("dry-sand", "0,0,0", {.walk_s = 8.0, .start_walking = true});
  EXPECT_TRUE(still.survived) << still.fall_reason;
  EXPECT_LT(std::abs(still.figures.motion->mean_velocity_mps[0]), 0.1);
}

TEST(ShippedPolicyTest, RunsWithNoiseDelayAndTheDrivesTorqueSpeedLine) {
  const RunResult result =
      run("dry-sand", "1.5,0,0", {.walk_s = 8.0, .start_walking = true},
          {"sim.noise.joint_position_rad=0.02", "sim.noise.joint_velocity_radps=0.3",
           "sim.noise.angular_velocity_radps=0.1", "sim.noise.orientation_rad=0.02",
           "sim.actuator_delay_ticks=20", "sim.torque_speed_line=true"});
  EXPECT_TRUE(result.survived) << result.fall_reason;
  EXPECT_GT(result.figures.motion->mean_velocity_mps[0], 1.2);
}

}  // namespace
}  // namespace sandrunner
