// SPDX-License-Identifier: BSD-3-Clause
// What the controller makes of time: stalls of the loop, time that does not go on, a robot that is
// not where it should be by now, an operator who is gone.
#include <gtest/gtest.h>

#include <cmath>

#include "fake_robot.h"

namespace sandrunner {
namespace {

constexpr std::uint64_t bit(Fault fault) { return static_cast<std::uint64_t>(fault); }

class TimeTest : public testing::TestWithParam<Mode> {};

TEST_P(TimeTest, ThatStandsStillOrGoesBackIsAFault) {
  for (const std::uint64_t back : {1, 2, 100000}) {
    FakeLoop loop;
    loop.run_s(0.01);
    loop.reach(GetParam());
    loop.spoil = [&](ControllerInput& seen) {
      const std::uint64_t tick = seen.sensors.tick - std::min(back, seen.sensors.tick);
      seen.sensors.tick = seen.sensors.imu.tick = tick;
      seen.sensors.joints.tick.fill(tick);
    };
    loop.tick();
    EXPECT_NE(loop.output.faults & bit(Fault::kTime), 0u);
    EXPECT_TRUE(only_brakes(loop.output.command));
    EXPECT_EQ(loop.output.command.enabled(), GetParam() != Mode::kPassive);
  }
}

TEST_P(TimeTest, DrivesGoOffForGoodAfterAFaultHoweverTimeGoes) {
  FakeLoop loop;
  loop.reach(GetParam());
  const std::uint64_t stopped = loop.robot.now.tick - 1;
  bool back = false;
  loop.spoil = [&](ControllerInput& seen) { seen.sensors.tick = back ? stopped / 2 : stopped; };
  for (std::uint64_t n = 0; n <= ticks_from_s(2.0); ++n) loop.tick();
  EXPECT_EQ(loop.output.mode, Mode::kFault);
  EXPECT_FALSE(loop.output.command.enabled());
  back = true;
  for (int n = 0; n < 10; ++n) {
    loop.tick();
    EXPECT_FALSE(loop.output.command.enabled());
  }
}

INSTANTIATE_TEST_SUITE_P(EachMode, TimeTest,
                         testing::Values(Mode::kPassive, Mode::kDamping, Mode::kStandUp,
                                         Mode::kStand, Mode::kWalk),
                         [](const auto& param_info) { return mode_name(param_info.param); });

TEST(StallTest, OfThirtyMillisecondsIsNoFaultAndMakesNothingOlder) {
  for (const Mode mode : {Mode::kDamping, Mode::kStandUp, Mode::kStand, Mode::kWalk}) {
    FakeLoop loop;
    loop.reach(mode);
    while (loop.robot.now.tick % kTicksPerPolicyStep != 39) loop.tick();
    // Neither drives nor IMU nor the policy answered during it, and not at once after it.
    const ControllerInput last = loop.input;
    loop.robot.now.tick += 120;
    loop.spoil = [&](ControllerInput& seen) {
      const std::uint64_t tick = seen.sensors.tick;
      seen.sensors = last.sensors;
      seen.sensors.tick = tick;
    };
    for (int n = 0; n < 5; ++n) loop.tick();
    loop.spoil = nullptr;
    loop.run_s(0.5);
    EXPECT_EQ(loop.output.mode, mode);
    EXPECT_EQ(loop.controller.state().gate.counters.stalled, 1u);
  }
}

TEST(StallTest, ASilentDriveBeforeItIsStillSilentAfterIt) {
  FakeLoop loop;
  loop.reach(Mode::kStand);
  const std::uint64_t silent_since = loop.robot.now.tick;
  loop.spoil = [&](ControllerInput& seen) { seen.sensors.joints.tick[3] = silent_since; };
  for (int n = 0; n < 8; ++n) loop.tick();
  loop.robot.now.tick += 50;
  loop.tick();
  EXPECT_EQ(loop.output.faults, 0u);
  loop.tick();
  EXPECT_EQ(loop.output.faults, bit(Fault::kJointsStale));
}

TEST(StallTest, StandingUpGoesOnWhereItWas) {
  FakeLoop loop;
  loop.reach(Mode::kStandUp);
  loop.run_s(0.5);
  const JointArray<double> before_rad = loop.output.command.joints().position_rad;
  loop.robot.now.tick += 120;
  loop.tick();
  for (int j = 0; j < kNumJoints; ++j) {
    EXPECT_NEAR(loop.output.command.joints().position_rad[j], before_rad[j],
                loop.config.stand.max_speed_radps * kControlPeriod_s);
  }
}

TEST(StandTest, IsReachedByPostureAndNotByTime) {
  FakeLoop loop;
  loop.reach(Mode::kStandUp);
  // Joint 4 stays behind.
  const double behind_rad = loop.config.stand.nominal_rad[4] + 0.3;
  loop.spoil = [&](ControllerInput& seen) {
    double& q = seen.sensors.joints.position_rad[4];
    q = std::max(q, behind_rad) + (seen.sensors.tick % 2 == 0 ? kTremble_rad : 0.0);
    seen.sensors.joints.velocity_radps[4] = 0.0;
    seen.sensors.joints.torque_nm[4] = loop.controller.state().gate.joints.commanded_nm[4];
  };
  loop.run_s(3.4);
  EXPECT_EQ(loop.output.mode, Mode::kStandUp);
  loop.run_s(0.2);
  EXPECT_EQ(loop.output.faults, bit(Fault::kNotStanding));
  EXPECT_TRUE(only_brakes(loop.output.command));
}

TEST(LostOperatorTest, WalksAtZeroThenStandsThenLiesDown) {
  ControllerConfig config = test_robot();
  config.shaping.operator_hold_ticks = ticks_from_s(0.3);
  config.shaping.operator_stand_s = 2.0;
  config.shaping.operator_down_s = 8.0;
  FakeLoop loop(Mode::kPassive, config);
  const auto alive = [&](double duration_s) {
    for (std::uint64_t n = ticks_from_s(duration_s); n > 0; --n) {
      loop.input.command.tick = loop.robot.now.tick;
      loop.tick();
    }
  };
  loop.input.command.tick = 0;
  loop.stand_up();
  alive(3.0);
  loop.request(ModeRequest::kWalk);
  alive(1.0);
  ASSERT_EQ(loop.output.policy_input.command.vx_mps, 1.0);
  loop.run_s(1.9);
  EXPECT_EQ(loop.output.policy_input.command.vx_mps, 0.0);
  EXPECT_EQ(loop.output.mode, Mode::kWalk);
  loop.run_s(1.0);
  EXPECT_EQ(loop.output.mode, Mode::kStand);
  loop.run_s(5.0);
  EXPECT_EQ(loop.output.mode, Mode::kStand);
  loop.run_s(0.2);
  EXPECT_EQ(loop.output.mode, Mode::kStand);
  EXPECT_NE(loop.output.command.joints().position_rad, config.stand.nominal_rad);
  loop.run_s(1.5);
  EXPECT_EQ(loop.output.mode, Mode::kDamping);
}

TEST(LostOperatorTest, WhoCannotBeLostIsNotMissed) {
  FakeLoop loop;
  loop.reach(Mode::kWalk);
  loop.input.command.tick = 0;
  loop.run_s(200.0);
  EXPECT_EQ(loop.output.mode, Mode::kWalk);
  EXPECT_EQ(loop.output.policy_input.command.vx_mps, 1.0);
}

}  // namespace
}  // namespace sandrunner
