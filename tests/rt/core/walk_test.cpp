// SPDX-License-Identifier: BSD-3-Clause
// Walk: when the policy is released, when its output counts, what it is commanded.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "fake_robot.h"

namespace sandrunner {
namespace {

TEST(WalkTest, StartInWalkReleasesThePolicyAtOnceWithTheCommand) {
  FakeLoop loop(Mode::kWalk);
  loop.action_rad.fill(-0.5);
  loop.tick();
  EXPECT_EQ(loop.output.mode, Mode::kWalk);
  EXPECT_EQ(loop.output.release_policy, 1u);
  EXPECT_EQ(loop.output.policy_input.tick, 0u);
  EXPECT_EQ(loop.output.policy_input.episode, 1u);
  EXPECT_EQ(loop.output.policy_input.command.vx_mps, 1.0);
  // Until the first answer: nominal posture, already with the policy's gains.
  EXPECT_EQ(loop.output.command.joints().position_rad, loop.config.stand.nominal_rad);
  EXPECT_EQ(loop.output.command.joints().kp_nmprad[0], 50.0);
  EXPECT_EQ(loop.output.command.joints().kd_nmsprad[0], 0.5);
  loop.tick();
  EXPECT_EQ(loop.output.release_policy, 0u);
  EXPECT_EQ(loop.output.command.joints().position_rad, loop.action_rad);
  EXPECT_EQ(loop.output.command.joints().velocity_radps, JointArray<double>{});
  EXPECT_EQ(loop.output.command.joints().feedforward_nm, JointArray<double>{});
  EXPECT_EQ(loop.controller.state().late_policy_outputs, 0u);
}

TEST(WalkTest, PolicyIsReleasedOnEveryFortiethTick) {
  FakeLoop loop;
  loop.reach(Mode::kStand);
  while (loop.robot.now.tick % 40 != 13) loop.tick();
  loop.request(ModeRequest::kWalk);
  EXPECT_EQ(loop.output.mode, Mode::kWalk);
  EXPECT_EQ(loop.output.release_policy, 0u);  // waits for the grid
  int releases = 0;
  for (int n = 0; n < 400; ++n) {
    loop.tick();
    EXPECT_EQ(loop.output.release_policy, loop.output.policy_input.tick % 40 == 0 ? 1u : 0u);
    releases += loop.output.release_policy != 0 ? 1 : 0;
  }
  EXPECT_EQ(releases, 10);
}

TEST(WalkTest, SkippedTicksDelayAReleaseButDoNotLoseIt) {
  FakeLoop loop(Mode::kWalk);
  while (loop.robot.now.tick < 39) loop.tick();
  loop.robot.now.tick = 42;
  loop.tick();
  EXPECT_EQ(loop.output.release_policy, 1u);
  loop.tick();
  EXPECT_EQ(loop.output.release_policy, 0u);
  while (loop.robot.now.tick < 80) loop.tick();
  loop.tick();
  EXPECT_EQ(loop.output.release_policy, 1u);
}

TEST(WalkTest, PolicyIsNotReleasedOutsideWalk) {
  FakeLoop loop;
  loop.reach(Mode::kStand);
  for (int n = 0; n < 200; ++n) {
    loop.tick();
    ASSERT_EQ(loop.output.release_policy, 0u);
    ASSERT_EQ(loop.output.policy_input.command.vx_mps, 0.0);
  }
}

TEST(WalkTest, OutputWaitsForItsLatency) {
  ControllerConfig config = test_robot();
  config.walk.latency_ticks = 8;
  FakeLoop loop(Mode::kWalk, config);
  loop.action_rad.fill(-0.5);
  for (int n = 0; n < 8; ++n) {
    loop.tick();
    ASSERT_EQ(loop.output.command.joints().position_rad, config.stand.nominal_rad);
  }
  loop.tick();
  EXPECT_EQ(loop.output.command.joints().position_rad, loop.action_rad);
  EXPECT_EQ(loop.controller.state().late_policy_outputs, 0u);
}

TEST(WalkTest, LateOutputIsTakenAtOnceAndCounted) {
  FakeLoop loop(Mode::kWalk);
  loop.action_rad.fill(-0.5);
  loop.spoil = [](ControllerInput& seen) {
    if (seen.sensors.tick < 25) seen.policy = {};
  };
  for (int n = 0; n < 25; ++n) loop.tick();
  EXPECT_EQ(loop.output.command.joints().position_rad, loop.config.stand.nominal_rad);
  loop.tick();
  EXPECT_EQ(loop.output.command.joints().position_rad, loop.action_rad);
  loop.run_s(0.1);
  EXPECT_EQ(loop.controller.state().late_policy_outputs, 1u);
}

TEST(WalkTest, MissedOutputHoldsTheLastTarget) {
  FakeLoop loop(Mode::kWalk);
  loop.action_rad.fill(-0.5);
  loop.run_s(0.005);
  const JointArray<double> held_rad = loop.action_rad;
  loop.policy_hangs = true;
  for (int n = 0; n < 100; ++n) {
    loop.tick();
    ASSERT_EQ(loop.output.command.joints().position_rad, held_rad);
  }
  loop.policy_hangs = false;
  loop.run_s(0.05);
  EXPECT_EQ(loop.output.mode, Mode::kWalk);
}

TEST(WalkTest, OutputOfAnotherEpisodeDoesNotCount) {
  FakeLoop loop;
  loop.reach(Mode::kWalk);
  loop.request(ModeRequest::kStand);
  loop.run_s(3.0);
  ASSERT_EQ(loop.output.mode, Mode::kStand);
  loop.policy.target_rad.fill(std::numeric_limits<double>::quiet_NaN());  // left over
  loop.policy_hangs = true;
  loop.request(ModeRequest::kWalk);
  EXPECT_EQ(loop.output.policy_input.episode, 2u);
  for (int n = 0; n < 50; ++n) {
    loop.tick();
    ASSERT_EQ(loop.output.mode, Mode::kWalk);
    ASSERT_EQ(loop.output.command.joints().position_rad, loop.config.stand.nominal_rad);
  }
}

TEST(WalkTest, NewEpisodeStartsAfresh) {
  ControllerConfig config = test_robot();
  config.shaping.envelope.acceleration_mps2 = 1.0;
  FakeLoop loop(Mode::kPassive, config);
  loop.reach(Mode::kWalk);
  loop.run_s(1.0);
  ASSERT_EQ(loop.output.policy_input.command.vx_mps, 1.0);
  loop.request(ModeRequest::kDamp);
  loop.request(ModeRequest::kStand);
  loop.run_s(3.0);
  loop.policy.sequence = 0;  // a policy may count anew
  loop.action_rad.fill(-0.5);
  loop.request(ModeRequest::kWalk);
  EXPECT_NEAR(loop.output.policy_input.command.vx_mps, kControlPeriod_s, 1e-12);
  loop.run_s(0.02);
  EXPECT_EQ(loop.output.command.joints().position_rad, loop.policy.target_rad);
}

TEST(WalkTest, OutputFromTheFutureDoesNotCount) {
  FakeLoop loop(Mode::kWalk);
  loop.tick();
  loop.policy.input_tick = ~std::uint64_t{0};
  loop.policy.target_rad.fill(-0.5);
  loop.policy_hangs = true;
  loop.tick();
  EXPECT_EQ(loop.output.command.joints().position_rad, loop.config.stand.nominal_rad);
}

TEST(WalkTest, WildTargetGivesTheJointsTorqueAndNoMoreAndIsCounted) {
  FakeLoop loop(Mode::kWalk);
  loop.action_rad.fill(1e6);
  loop.tick();
  loop.tick();
  EXPECT_NEAR(loop.output.command.joints().position_rad[2], -1.2 + 60.0 / 50.0, 1e-12);
  EXPECT_EQ(loop.controller.state().gate.counters.position_clamped, 1u);
  EXPECT_EQ(loop.controller.state().gate.counters.torque_clamped, 1u);
}

TEST(WalkTest, CommandBeyondTheEnvelopeIsBroughtInsideAndTheShareLeftIsTold) {
  FakeLoop loop(Mode::kWalk);
  loop.input.command.velocity = {1.0, -0.2, 0.3};
  loop.tick();
  EXPECT_EQ(loop.output.policy_input.command.vx_mps, 1.0);
  EXPECT_EQ(loop.output.policy_input.command.vy_mps, -0.2);
  EXPECT_EQ(loop.output.policy_input.command.wz_radps, 0.3);
  EXPECT_EQ(loop.output.command_share, 1.0);
  EXPECT_EQ(loop.controller.state().gate.counters.command_clamped, 0u);
  loop.input.command.velocity = {0.0, -2.0, 0.3};
  loop.tick();
  EXPECT_NEAR(loop.output.policy_input.command.vy_mps, -0.5, 1e-12);
  EXPECT_EQ(loop.output.policy_input.command.wz_radps, 0.3);
  EXPECT_NEAR(loop.output.command_share, 0.25, 1e-12);
  EXPECT_EQ(loop.controller.state().gate.counters.command_clamped, 1u);
}

TEST(WalkTest, YawRateIsClippedToTheCentripetalLimit) {
  ControllerConfig config = test_robot();
  config.shaping.envelope = {5.0, 5.0, 10.0, 5.0, 1e9, 1e9};
  FakeLoop loop(Mode::kWalk, config);
  loop.input.command.velocity = {3.0, 4.0, -2.0};
  loop.tick();
  EXPECT_DOUBLE_EQ(loop.output.policy_input.command.wz_radps, -2.943 / 5.0);
  loop.input.command.velocity = {0.0, 0.0, -2.0};
  loop.tick();
  EXPECT_EQ(loop.output.policy_input.command.wz_radps, -2.0);
}

TEST(WalkTest, SlewLimitsBoundTheCommand) {
  ControllerConfig config = test_robot();
  config.shaping.envelope = {2.0, 2.0, 2.0, 2.0, 4.0, 8.0};
  FakeLoop loop(Mode::kWalk, config);
  loop.input.command.velocity = {1.0, -1.0, 1.0};
  for (int n = 1; n <= 1000; ++n) {
    loop.tick();
    const VelocityCommand& now = loop.output.policy_input.command;
    ASSERT_NEAR(now.vx_mps, 0.001 * n, 1e-9);
    ASSERT_EQ(now.vy_mps, -now.vx_mps);
    ASSERT_NEAR(now.wz_radps, std::min(1.0, 0.002 * n), 1e-9);
  }
  loop.tick();
  EXPECT_EQ(loop.output.policy_input.command.vx_mps, 1.0);
}

TEST(WalkTest, RobotStopsWhenItsOperatorIsLost) {
  ControllerConfig config = test_robot();
  config.shaping.operator_hold_ticks = 100;
  FakeLoop loop(Mode::kWalk, config);
  for (int n = 0; n <= 100; ++n) {
    loop.tick();
    ASSERT_EQ(loop.output.policy_input.command.vx_mps, 1.0);
  }
  // It slows down as in a stop: 1 m/s at 1 m/s^2.
  for (int n = 0; n < 4000; ++n) {
    const double before_mps = loop.output.policy_input.command.vx_mps;
    loop.tick();
    ASSERT_NEAR(loop.output.policy_input.command.vx_mps, std::max(before_mps - 0.25e-3, 0.0), 1e-9);
  }
  EXPECT_NEAR(loop.output.policy_input.command.vx_mps, 0.0, 1e-9);
  EXPECT_EQ(loop.output.mode, Mode::kWalk);
  loop.input.command.tick = loop.robot.now.tick;
  loop.tick();
  EXPECT_EQ(loop.output.policy_input.command.vx_mps, 1.0);
}

}  // namespace
}  // namespace sandrunner
