// SPDX-License-Identifier: BSD-3-Clause
// Conditions that creep up: the robot stops, stands and lies down, and does not rise while they
// hold.
#include "rt/core/warnings.h"

#include <gtest/gtest.h>

#include "fake_robot.h"

namespace sandrunner {
namespace {

const std::uint64_t kDrive = warning_bit(Warning::kDriveWarning);

/// A loop in `mode` whose fourth drive gets warm.
struct WarmLoop : FakeLoop {
  explicit WarmLoop(Mode mode) {
    reach(mode);
    spoil = [this](ControllerInput& seen) { seen.sensors.joints.drive_warning[3] = warm ? 1 : 0; };
  }
  bool warm = true;
};

TEST(WarningTest, AWalkingRobotStopsStandsAndLiesDownWithoutAFault) {
  WarmLoop loop(Mode::kWalk);
  loop.tick();
  EXPECT_EQ(loop.output.warnings, kDrive);
  EXPECT_EQ(loop.output.mode, Mode::kWalk);
  loop.run_s(0.5);
  EXPECT_LT(loop.output.policy_input.command.vx_mps, 0.6);
  loop.run_s(2.0);
  EXPECT_EQ(loop.output.mode, Mode::kStand);
  loop.run_s(3.0);
  EXPECT_EQ(loop.output.mode, Mode::kDamping);
  EXPECT_EQ(loop.output.faults, 0u);
}

TEST(WarningTest, OneThatIsOverStillEndsTheMotion) {
  WarmLoop loop(Mode::kWalk);
  loop.tick();
  loop.warm = false;
  loop.run_s(6.0);
  EXPECT_EQ(loop.output.mode, Mode::kDamping);
  EXPECT_EQ(loop.output.warnings, 0u);
}

TEST(WarningTest, AStandingRobotLiesDown) {
  WarmLoop loop(Mode::kStand);
  loop.run_s(3.0);
  EXPECT_EQ(loop.output.mode, Mode::kDamping);
}

TEST(WarningTest, ARobotThatStandsUpGoesBackDown) {
  WarmLoop folding(Mode::kStandUp);
  folding.tick();
  folding.tick();
  EXPECT_EQ(folding.output.mode, Mode::kDamping);

  WarmLoop extending(Mode::kStandUp);
  extending.warm = false;
  extending.run_s(1.5);
  ASSERT_EQ(extending.output.mode, Mode::kStandUp);
  extending.warm = true;
  extending.run_s(3.0);
  EXPECT_EQ(extending.output.mode, Mode::kDamping);
}

TEST(WarningTest, NoRequestTakesTheRobotUpAgainWhileItHolds) {
  WarmLoop loop(Mode::kWalk);
  loop.tick();
  loop.tick();
  for (int n = 0; n < 60; ++n) {
    loop.request(n % 2 == 0 ? ModeRequest::kWalk : ModeRequest::kStand);
    loop.run_s(0.1);
  }
  EXPECT_EQ(loop.output.mode, Mode::kDamping);
  loop.warm = false;
  loop.tick();
  loop.request(ModeRequest::kStand);
  EXPECT_EQ(loop.output.mode, Mode::kStandUp);
}

TEST(WarningTest, DampAndFaultsStillActAtOnce) {
  WarmLoop damped(Mode::kWalk);
  damped.tick();
  damped.request(ModeRequest::kDamp);
  EXPECT_EQ(damped.output.mode, Mode::kDamping);

  WarmLoop faulty(Mode::kWalk);
  faulty.tick();
  faulty.spoil = [](ControllerInput& seen) { seen.sensors.joints.drive_fault[3] = 1; };
  faulty.tick();
  EXPECT_EQ(faulty.output.mode, Mode::kFault);
}

TEST(WarningTest, AnImuThatIsLateIsAWarningBeforeItIsAFault) {
  FakeLoop loop;
  loop.reach(Mode::kWalk);
  const ImuSample last = loop.input.sensors.imu;
  loop.spoil = [&](ControllerInput& seen) { seen.sensors.imu = last; };
  for (int age = 1; age <= 40; ++age) loop.tick();
  EXPECT_EQ(loop.output.warnings, 0u);
  loop.tick();
  EXPECT_EQ(loop.output.warnings, warning_bit(Warning::kImuLate));
  for (int age = 42; age <= 120; ++age) loop.tick();
  EXPECT_EQ(loop.output.faults, 0u);
  loop.tick();
  EXPECT_EQ(loop.output.first_fault, Fault::kImuStale);
}

TEST(WarningTest, ADriveThatHeatsUpIsAWarningBeforeItIsAnOverload) {
  FakeLoop loop;
  loop.reach(Mode::kStand);
  double& torque_nm = loop.robot.now.joints.torque_nm[4];
  ControllerState state = loop.controller.state();
  state.gate.heat_n2m2[4] = 0.89 * 30.0 * 30.0;
  loop.controller.restore(state);
  torque_nm = 29.0;
  loop.tick();
  EXPECT_EQ(loop.output.warnings, 0u);
  state.gate.heat_n2m2[4] = 0.91 * 30.0 * 30.0;
  loop.controller.restore(state);
  loop.tick();
  EXPECT_EQ(loop.output.warnings, warning_bit(Warning::kHeating));
  EXPECT_EQ(loop.output.faults, 0u);
}

}  // namespace
}  // namespace sandrunner
