// SPDX-License-Identifier: BSD-3-Clause
// Drives the whole loop over every fault threshold.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

#include "fake_robot.h"
#include "rt/core/rotation.h"
#include "tests/support/not_finite.h"

namespace sandrunner {
namespace {

constexpr std::uint64_t kTicksIn2ms = 8;

std::array<double, 4> tilted(double angle_deg) {
  const double half_rad = angle_deg * std::numbers::pi / 360.0;
  return {std::cos(half_rad), 0.0, std::sin(half_rad), 0.0};
}

struct FaultCase {
  Fault fault;
  Mode mode;
  /// Ticks of the disturbance until it crosses the fault threshold: before, the robot goes on.
  std::uint64_t ticks_to_threshold;
  /// The disturbance, from tick 0 on; `last` are the inputs before it began.
  void (*disturb)(ControllerInput& seen, const ControllerInput& last);
  std::uint64_t also = 0;  ///< bits of faults that arise in the same tick
};

constexpr std::uint64_t kJumped = fault_bit(Fault::kEncoderJump) | fault_bit(Fault::kSpeedMismatch);

const FaultCase kFaultCases[] = {
    {Fault::kNonFiniteAction, Mode::kWalk, 0,
     [](auto& seen, auto&) { seen.policy.target_rad[3] = kNan; }},
    {Fault::kNonFiniteJoint, Mode::kStand, 0,
     [](auto& seen, auto&) { seen.sensors.joints.velocity_radps[11] = kInf; }},
    {Fault::kNonFiniteImu, Mode::kStand, 0,
     [](auto& seen, auto&) { seen.sensors.imu.angular_velocity_radps[2] = kNan; }},
    {Fault::kNonFiniteCommand, Mode::kDamping, 0,
     [](auto& seen, auto&) { seen.command.velocity.wz_radps = kNan; }},
    // The first disturbed tick sees values of age 1; ages 8 and 120 are the last that pass.
    {Fault::kJointsStale, Mode::kWalk, 8,
     [](auto& seen, auto& last) { seen.sensors.joints = last.sensors.joints; }},
    {Fault::kImuStale, Mode::kDamping, 120,
     [](auto& seen, auto& last) { seen.sensors.imu = last.sensors.imu; }},
    {Fault::kJointPosition, Mode::kStand, 0,
     [](auto& seen, auto&) { seen.sensors.joints.position_rad[2] = 0.351; }, kJumped},
    {Fault::kJointPosition, Mode::kDamping, 0,
     [](auto& seen, auto&) { seen.sensors.joints.position_rad[8] = -2.5 - 0.351; }, kJumped},
    {Fault::kJointSpeed, Mode::kWalk, 0,
     [](auto& seen, auto&) { seen.sensors.joints.velocity_radps[7] = -60.1; }},
    {Fault::kJointTorque, Mode::kWalk, 19,
     [](auto& seen, auto&) { seen.sensors.joints.torque_nm[5] = -72.1; }},
    {Fault::kTilt, Mode::kWalk, 0,
     [](auto& seen, auto&) { seen.sensors.imu.orientation_wxyz = tilted(60.1); },
     fault_bit(Fault::kImuGyro)},
    {Fault::kTilt, Mode::kStandUp, 0,
     [](auto& seen, auto&) { seen.sensors.imu.orientation_wxyz = tilted(-170.0); },
     fault_bit(Fault::kImuGyro)},
};

std::uint64_t bits(const FaultCase& c) { return fault_bit(c.fault) | c.also; }

void PrintTo(const FaultCase& fault_case, std::ostream* out) {
  *out << fault_name(fault_case.fault) << " in " << mode_name(fault_case.mode);
}

class FaultCaseTest : public testing::TestWithParam<FaultCase> {};

TEST_P(FaultCaseTest, BrakesWithinTwoMillisecondsThenSwitchesOff) {
  const FaultCase& fault_case = GetParam();
  FakeLoop loop;
  loop.reach(fault_case.mode);
  ASSERT_EQ(loop.output.mode, fault_case.mode);
  ASSERT_EQ(loop.output.faults, 0u);

  const ControllerInput last = loop.input;
  loop.spoil = [&](ControllerInput& seen) { fault_case.disturb(seen, last); };
  for (std::uint64_t n = 0; n < fault_case.ticks_to_threshold; ++n) {
    loop.tick();
    ASSERT_EQ(loop.output.mode, fault_case.mode) << "fault too early, tick " << n;
    ASSERT_EQ(loop.output.faults, 0u);
  }
  std::uint64_t ticks = 0;
  do {
    loop.tick();
    ++ticks;
  } while (loop.output.mode != Mode::kFault && ticks < 100);
  EXPECT_LE(ticks, kTicksIn2ms);
  EXPECT_EQ(ticks, 1u);  // in the tick that sees it
  EXPECT_TRUE(only_brakes(loop.output.command));
  EXPECT_TRUE(loop.output.command.enabled());
  EXPECT_EQ(loop.output.command.joints().kd_nmsprad[0], 2.0);
  EXPECT_EQ(loop.output.faults, bits(fault_case));
  EXPECT_EQ(loop.controller.state().gate.first_fault, fault_case.fault);
  EXPECT_EQ(loop.output.fault_joints, loop.controller.state().gate.fault_joints);
  EXPECT_EQ(loop.controller.state().gate.first_fault_tick, loop.output.policy_input.tick);

  // Latched: the end of the disturbance changes nothing.
  loop.spoil = nullptr;
  for (std::uint64_t n = 1; n < ticks_from_s(2.0); ++n) {
    loop.tick();
    ASSERT_TRUE(only_brakes(loop.output.command) && loop.output.command.enabled());
  }
  loop.tick();
  EXPECT_FALSE(loop.output.command.enabled());
  EXPECT_EQ(loop.output.mode, Mode::kFault);
  EXPECT_EQ(loop.output.faults, bits(fault_case));
}

INSTANTIATE_TEST_SUITE_P(EachFault, FaultCaseTest, testing::ValuesIn(kFaultCases),
                         [](const auto& param_info) {
                           return std::string(fault_name(param_info.param.fault)) + "_in_" +
                                  mode_name(param_info.param.mode);
                         });

TEST(FaultsTest, PolicyThatHangsIsHeldForThreePeriodsThenStale) {
  FakeLoop loop;
  loop.reach(Mode::kWalk);
  loop.policy_hangs = true;
  const std::uint64_t last_input_tick = loop.policy.input_tick;
  while (loop.output.mode == Mode::kWalk) {
    ASSERT_LE(loop.robot.now.tick - last_input_tick, 121u);
    loop.tick();
  }
  EXPECT_EQ(loop.output.policy_input.tick - last_input_tick, 121u);
  EXPECT_EQ(loop.controller.state().gate.first_fault, Fault::kPolicyStale);
  EXPECT_TRUE(only_brakes(loop.output.command));
  EXPECT_EQ(loop.output.release_policy, 0u);
}

TEST(FaultsTest, PolicyThatNeverAnswersIsStaleToo) {
  FakeLoop loop(Mode::kWalk);
  loop.policy_hangs = true;
  for (int n = 0; n <= 120; ++n) loop.tick();
  EXPECT_EQ(loop.output.mode, Mode::kWalk);
  loop.tick();
  EXPECT_EQ(loop.controller.state().gate.first_fault, Fault::kPolicyStale);
}

TEST(FaultsTest, ControllerThatComputesNonsenseIsStopped) {
  ControllerConfig config = test_robot();
  config.walk.kp_nmprad = kNan;
  FakeLoop loop(Mode::kWalk, config);
  for (int n = 0; n < 2; ++n) {
    loop.tick();
    EXPECT_EQ(loop.output.mode, Mode::kFault);
    EXPECT_EQ(loop.controller.state().gate.first_fault, Fault::kNonFiniteOutput);
    EXPECT_TRUE(only_brakes(loop.output.command));
    EXPECT_TRUE(loop.output.command.enabled());
  }
}

TEST(FaultsTest, PassiveIgnoresHowTheRobotLies) {
  FakeLoop loop;
  loop.spoil = [](ControllerInput& seen) {
    seen.sensors.joints.position_rad[2] = 3.0;
    seen.sensors.joints.velocity_radps[2] = 90.0;
    seen.sensors.joints.torque_nm[2] = 90.0;
    seen.sensors.imu.orientation_wxyz = tilted(180.0);
  };
  loop.run_s(0.02);
  EXPECT_EQ(loop.output.mode, Mode::kPassive);
  EXPECT_EQ(loop.output.faults, 0u);
  // But it does not get up like that, not for a single tick.
  loop.stand_up();
  EXPECT_EQ(loop.output.mode, Mode::kFault);
  EXPECT_TRUE(only_brakes(loop.output.command));
}

TEST(FaultsTest, FaultInPassiveDoesNotSwitchDrivesOn) {
  FakeLoop loop;
  loop.run_s(0.01);
  loop.spoil = [](ControllerInput& seen) { seen.sensors.joints.tick.fill(0); };
  loop.tick();
  EXPECT_EQ(loop.controller.state().gate.first_fault, Fault::kJointsStale);
  EXPECT_EQ(loop.output.mode, Mode::kFault);
  EXPECT_FALSE(loop.output.command.enabled());
}

class ResetTest : public testing::Test {
 protected:
  ResetTest() {
    loop.reach(Mode::kStand);
    loop.spoil = too_fast;
    loop.tick();
  }
  static void too_fast(ControllerInput& seen) { seen.sensors.joints.velocity_radps[0] = 70.0; }
  FakeLoop loop;
};

TEST_F(ResetTest, RefusedWhileDrivesAreOn) {
  loop.spoil = nullptr;
  loop.request(ModeRequest::kResetFault);
  EXPECT_EQ(loop.output.mode, Mode::kFault);
  // The refused request does not wait in a queue.
  loop.run_s(3.0);
  EXPECT_EQ(loop.output.mode, Mode::kFault);
}

TEST_F(ResetTest, RefusedWhileTheConditionHolds) {
  loop.run_s(2.1);
  loop.request(ModeRequest::kResetFault);
  EXPECT_EQ(loop.output.mode, Mode::kFault);
  EXPECT_NE(loop.output.faults, 0u);
  EXPECT_FALSE(loop.output.command.enabled());
}

TEST_F(ResetTest, RefusedWhileTheRobotLiesOnItsSide) {
  loop.spoil = [](ControllerInput& seen) {
    ImuSample& imu = seen.sensors.imu;
    imu.orientation_wxyz = tilted(90.0);
    imu.linear_acceleration_mps2 =
        rotated(inverse(imu.orientation_wxyz), imu.linear_acceleration_mps2);
  };
  loop.run_s(2.1);
  loop.request(ModeRequest::kResetFault);
  EXPECT_EQ(loop.output.mode, Mode::kFault);
  loop.spoil = nullptr;
  loop.run_s(15.0);  // it turned without a sign of the gyroscope
  loop.request(ModeRequest::kResetFault);
  EXPECT_EQ(loop.output.mode, Mode::kPassive);
}

TEST_F(ResetTest, LeadsToPassiveAndNeverFurther) {
  loop.spoil = nullptr;
  loop.run_s(2.1);
  loop.request(ModeRequest::kResetFault);
  EXPECT_EQ(loop.output.mode, Mode::kPassive);
  EXPECT_EQ(loop.output.faults, 0u);
  EXPECT_EQ(loop.controller.state().gate.first_fault, Fault::kJointSpeed);  // for the report
  for (int n = 0; n < 4000; ++n) {
    loop.tick();
    ASSERT_FALSE(loop.output.command.enabled());
  }
  loop.stand_up();
  EXPECT_EQ(loop.output.mode, Mode::kStandUp);
}

TEST_F(ResetTest, OtherRequestsDoNothing) {
  loop.spoil = nullptr;
  for (const double wait_s : {0.1, 3.0}) {  // drives on, drives off
    loop.run_s(wait_s);
    for (const auto wish : {ModeRequest::kPassive, ModeRequest::kDamp, ModeRequest::kStand,
                            ModeRequest::kWalk, ModeRequest::kNone}) {
      loop.request(wish);
      EXPECT_EQ(loop.output.mode, Mode::kFault);
      EXPECT_TRUE(only_brakes(loop.output.command));
    }
  }
}

TEST_F(ResetTest, SecondFaultIsAddedButTheFirstStaysFirst) {
  loop.spoil = [](ControllerInput& seen) { seen.sensors.joints.position_rad[0] = kNan; };
  loop.tick();
  EXPECT_EQ(loop.output.faults, fault_bit(Fault::kJointSpeed) | fault_bit(Fault::kNonFiniteJoint));
  EXPECT_EQ(loop.controller.state().gate.first_fault, Fault::kJointSpeed);
  EXPECT_TRUE(only_brakes(loop.output.command));
}

/// Pointers to every number that a controller is given.
std::vector<double*> numbers_of(ControllerInput& input) {
  std::vector<double*> all;
  const auto add = [&](auto& array) {
    for (double& value : array) all.push_back(&value);
  };
  add(input.sensors.joints.position_rad);
  add(input.sensors.joints.velocity_radps);
  add(input.sensors.joints.torque_nm);
  add(input.sensors.imu.orientation_wxyz);
  add(input.sensors.imu.angular_velocity_radps);
  add(input.sensors.imu.linear_acceleration_mps2);
  add(input.policy.target_rad);
  all.insert(all.end(), {&input.command.velocity.vx_mps, &input.command.velocity.vy_mps,
                         &input.command.velocity.wz_radps});
  return all;
}

TEST(FaultsTest, NoNumberThatIsNotFiniteEverMovesTheRobot) {
  for (const Mode mode :
       {Mode::kPassive, Mode::kDamping, Mode::kStandUp, Mode::kStand, Mode::kWalk}) {
    FakeLoop loop;
    loop.reach(mode);
    loop.tick();
    ASSERT_EQ(loop.output.mode, mode);
    const ControllerState before = loop.controller.state();
    ControllerInput input = loop.input;
    const std::vector<double*> numbers = numbers_of(input);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const bool is_action = i >= 46 && i < 58;
      for (const double bad : {kNan, kInf, -kInf}) {
        input = loop.input;
        ++input.sensors.tick;
        input.policy = loop.policy;
        *numbers[i] = bad;
        loop.controller.restore(before);
        loop.controller.step(input, loop.output);
        if (is_action && mode != Mode::kWalk) {
          EXPECT_EQ(loop.output.mode, mode);  // nobody listens to the policy
        } else {
          ASSERT_EQ(loop.output.mode, Mode::kFault) << mode_name(mode) << ", number " << i;
          ASSERT_TRUE(only_brakes(loop.output.command));
          ASSERT_EQ(loop.output.command.enabled(), mode != Mode::kPassive);
        }
      }
    }
  }
}

}  // namespace
}  // namespace sandrunner
