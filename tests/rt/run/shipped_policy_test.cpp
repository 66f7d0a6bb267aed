// SPDX-License-Identifier: BSD-3-Clause
// What the policy that ships must be able to do, through the whole control process. Bounds are what
// it is good for with a margin, not what it reached once.
#include <gtest/gtest.h>

#include "tests/rt/realtime/live_operator.h"
#include "tests/rt/support.h"

namespace sandrunner {
namespace {

RunResult run(const std::string& terrain, const std::string& command, const RunPlan& plan,
              const std::vector<std::string>& assignments = {}) {
  PolicyRunner policy(load_shipped_policy());
  const ProcessConfig config = config_of(terrain, assignments, policy.spec());
  return simulate({.config = config, .policy = policy, .command = command, .plan = plan});
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

TEST(ShippedPolicyTest, StandsAgainWhereItWentBackwardsOnTheSoftestSand) {
  // It leans on feet that lie in sand: pulled into Stand's posture in 0.5 s, it topples.
  const RunResult result = run("dry-sand", "-0.8,0,0", {.walk_s = 5.0},
                               {"terrain.sigma_flat_npm3=1e6", "terrain.sigma_cone_npm3=0.15e6"});
  EXPECT_TRUE(result.survived) << result.fall_reason;
}

TEST(ShippedPolicyTest, Go2StandsAgainWhereverInItsStrideAWalkEnds) {
  // It steps on the spot under a command of zero, until Stand takes over.
  PolicyRunner policy(load_shipped_policy("go2"));
  const ProcessConfig config = config_of("dry-sand", {"robot=go2"}, policy.spec());
  for (const double walk_s : {1.2, 1.3, 1.4, 2.0}) {
    const RunResult result = run_once(config, policy, {.walk_s = walk_s});
    EXPECT_TRUE(result.survived) << walk_s << " s: " << result.fall_reason;
  }
}

TEST(ShippedPolicyTest, StandsForAMinuteAfterAWalkThatLeftItsFeetInTheSand) {
  // By 30 N m of hip abduction at first, where 28 for long are an overload.
  PolicyRunner policy(load_shipped_policy());
  const ProcessConfig config = config_of("dry-sand", {}, policy.spec());
  LiveOperator op;
  Mode last = Mode::kPassive;
  const RunResult result = simulate({.config = config,
                                     .policy = policy,
                                     .plan = {.start_walking = true},
                                     .at_tick =
                                         [&](const TickRecord& tick) {
                                           last = tick.output.mode;
                                           const std::uint64_t n = tick.input.sensors.tick;
                                           if (n == 1) op.want(VelocityCommand{1.5, 0.0, 0.0});
                                           if (n == 3 * kControlHz) op.want(ModeRequest::kStand);
                                           if (n == 65 * kControlHz) op.end();
                                         },
                                     .live = &op});
  EXPECT_TRUE(result.survived) << result.fall_reason;
  EXPECT_EQ(last, Mode::kStand);
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
