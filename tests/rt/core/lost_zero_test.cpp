// SPDX-License-Identifier: BSD-3-Clause
// A joint that was silent may have lost its zero. It is not armed, however closely the requests
// follow each other.
#include <gtest/gtest.h>

#include "fake_robot.h"

namespace sandrunner {
namespace {

constexpr int kJoint = 4;

/// Lies in Fault, its drives off, as a joint was silent for 60 ms; `returns` ends that, the joint
/// one turn of its motor away.
class LostZeroTest : public testing::Test {
 protected:
  LostZeroTest() {
    loop.run_s(0.01);
    loop.spoil = [this](ControllerInput& seen) {
      JointState& joints = seen.sensors.joints;
      if (!returned) joints.tick[kJoint] = 40;
      if (returned) joints.position_rad[kJoint] += 0.93;
      seen.sensors.emergency_stop = pressed ? 1 : 0;
    };
    loop.run_s(0.06);
  }
  void returns() {
    returned = true;
    loop.run_s(0.01);
  }
  void expect_arm_refused() {
    request(ModeRequest::kArm, Mode::kFault);
    EXPECT_EQ(loop.output.first_fault, Fault::kJointMisplaced)
        << fault_name(loop.output.first_fault);
    EXPECT_FALSE(loop.output.command.enabled());
  }
  /// Each request comes in the tick after the one before.
  void request(ModeRequest wish, Mode expected) {
    loop.request(wish);
    EXPECT_EQ(loop.output.mode, expected);
  }

  FakeLoop loop;
  bool returned = false, pressed = false;
};

TEST_F(LostZeroTest, IsFoundIfArmFollowsTheResetAfterAWhile) {
  returns();
  request(ModeRequest::kResetFault, Mode::kPassive);
  loop.run_s(0.01);
  expect_arm_refused();
}

TEST_F(LostZeroTest, IsFoundIfArmFollowsTheResetInTheNextTick) {
  returns();
  request(ModeRequest::kResetFault, Mode::kPassive);
  expect_arm_refused();
}

TEST_F(LostZeroTest, IsFoundAfterARefusedResetAndAnotherInTheNextTick) {
  returns();
  pressed = true;
  request(ModeRequest::kResetFault, Mode::kFault);
  pressed = false;
  request(ModeRequest::kResetFault, Mode::kPassive);
  loop.run_s(0.01);
  expect_arm_refused();
}

TEST_F(LostZeroTest, IsFoundIfTheJointReturnsInTheTickOfTheReset) {
  returned = true;
  request(ModeRequest::kResetFault, Mode::kPassive);
  loop.run_s(0.01);
  expect_arm_refused();
}

TEST_F(LostZeroTest, IsFoundAgainIfTheResetFollowsTheRefusedArmInTheNextTick) {
  returns();
  request(ModeRequest::kResetFault, Mode::kPassive);
  loop.run_s(0.01);
  expect_arm_refused();
  request(ModeRequest::kResetFault, Mode::kPassive);
  loop.run_s(0.01);
  expect_arm_refused();
}

TEST_F(LostZeroTest, IsForgivenOnceTheJointWasWhereItShouldBe) {
  returns();
  request(ModeRequest::kResetFault, Mode::kPassive);
  loop.spoil = nullptr;
  loop.run_s(0.01);
  request(ModeRequest::kArm, Mode::kDamping);
  EXPECT_TRUE(loop.output.command.enabled());
}

/// Mode of a robot that is armed again after a stall of the loop in Fault, in which it sank: a
/// joint is 0.5 rad from where it was.
Mode armed_after_stall(std::uint64_t ticks) {
  FakeLoop loop;
  loop.reach(Mode::kStand);
  loop.robot.now.emergency_stop = 1;
  loop.run_s(0.01);
  loop.robot.now.emergency_stop = 0;
  loop.robot.now.tick += ticks;
  loop.run_s(2.5);
  loop.request(ModeRequest::kResetFault);
  EXPECT_EQ(loop.output.mode, Mode::kPassive);
  for (int n = 0; n < 4000; ++n) {
    loop.robot.now.joints.position_rad[kJoint] -= 0.5 / 4000.0;
    loop.tick();
  }
  loop.request(ModeRequest::kArm);
  return loop.output.mode;
}

TEST(LostZeroAfterStallTest, DrivesGoOnInAShortStallOfTheLoopAndMayRestartInALongOne) {
  EXPECT_EQ(armed_after_stall(220), Mode::kDamping);
  EXPECT_EQ(armed_after_stall(kRestart_ticks + 1), Mode::kFault);
}

}  // namespace
}  // namespace sandrunner
