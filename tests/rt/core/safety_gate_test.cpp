// SPDX-License-Identifier: BSD-3-Clause
#include "rt/core/safety_gate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <type_traits>

#include "fake_robot.h"
#include "tests/support/not_finite.h"

namespace sandrunner {
namespace {

// Only the gate makes a command that can move a motor.
static_assert(!std::is_constructible_v<SafeCommand, const JointCommand&, bool>);
static_assert(!std::is_constructible_v<SafeCommand, const JointCommand&>);
static_assert(!std::is_aggregate_v<SafeCommand>);
static_assert(!std::is_assignable_v<SafeCommand&, const JointCommand&>);
static_assert(std::is_default_constructible_v<SafeCommand>);
static_assert(std::is_copy_constructible_v<SafeCommand>);

class SafetyGateTest : public testing::Test {
 protected:
  SafetyGateTest() {
    sensors.joints.position_rad = test_robot().stand.nominal_rad;
    sensors.imu.linear_acceleration_mps2 = {0.0, 0.0, kGravity_mps2};
    wanted.position_rad = test_robot().stand.nominal_rad;
    wanted.kp_nmprad.fill(100.0);
    wanted.kd_nmsprad.fill(1.0);
  }
  std::uint64_t judge(Mode mode) { return judge(gate, mode); }
  /// In the tick after the last one, with samples as old as they were.
  std::uint64_t judge(const SafetyGate& by, Mode mode) {
    if (state.judged != 0 && sensors.tick <= state.tick) {
      const std::uint64_t on = state.tick + 1 - sensors.tick;
      for (std::uint64_t& tick : sensors.joints.tick) tick += on;
      sensors.imu.tick += on;
      sensors.tick += on;
    }
    if (trembles) tremble(sensors.imu);
    const GateInput input{
        .sensors = sensors, .command = command, .policy_input_tick = sensors.tick};
    const GateVerdict verdict = by.judge(input, mode, state);
    warnings = verdict.warnings;
    return verdict.faults;
  }
  SafeCommand pass(const JointCommand& to_pass, bool enabled = true) {
    return gate.pass(to_pass, enabled, sensors.joints, state);
  }
  /// The drives then report the torques that were commanded.
  void pass_and_follow() {
    pass(wanted);
    sensors.joints.torque_nm = state.joints.commanded_nm;
  }
  /// A tick in Stand; from then on joint 4 is commanded to `target_rad`.
  std::uint64_t stand_at(double target_rad) {
    const std::uint64_t found = judge(Mode::kStand);
    wanted.position_rad[4] = target_rad;
    pass_and_follow();
    return found;
  }
  void stamp(std::uint64_t tick, std::uint64_t joints_tick, std::uint64_t imu_tick) {
    sensors.tick = tick;
    sensors.joints.tick.fill(joints_tick);
    sensors.imu.tick = imu_tick;
  }
  /// The next tick is this many too late, with fresh samples.
  void stall(std::uint64_t missed) {
    const std::uint64_t tick = state.tick + 1 + missed;
    stamp(tick, tick, tick);
  }
  void tilt(double angle_deg) {
    const double half_rad = angle_deg * std::numbers::pi / 360.0;
    // About an axis in the plane, with a yaw before it: neither may matter.
    const double c = std::cos(half_rad), s = std::sin(half_rad), h = std::sqrt(0.5);
    sensors.imu.orientation_wxyz = {h * c, h * s * 0.6 - h * s * 0.8, h * s * 0.6 + h * s * 0.8,
                                    h * c};
  }

  GateConfig config = test_robot().gate;
  SafetyGate gate{config, {2.0, 2.0, 2.0}};
  GateState state;
  SensorFrame sensors;
  std::uint64_t warnings = 0;
  bool trembles = true;  ///< the IMU, as a real one
  VelocityCommand command;
  JointCommand wanted;
};

TEST_F(SafetyGateTest, DefaultCommandIsOff) {
  const SafeCommand command_off;
  EXPECT_FALSE(command_off.enabled());
  EXPECT_TRUE(only_brakes(command_off));
  EXPECT_EQ(command_off.joints().kd_nmsprad[0], 0.0);
}

TEST_F(SafetyGateTest, AfterAFaultAJointWhoseEncoderFreezesIsNoLongerBrakedByItsOldSpeed) {
  sensors.joints.velocity_radps.fill(0.02);  // at rest, by a coarse drive
  sensors.joints.velocity_radps[4] = 3.0;
  judge(Mode::kWalk);
  sensors.emergency_stop = 1;
  judge(Mode::kWalk);
  constexpr int kSoonest = 6;  // ticks: 3 rad/s for them is less than 0.005 rad
  for (int n = 0; n < kSoonest; ++n) judge(Mode::kFault);
  EXPECT_EQ(pass(wanted).blind_joints(), 0u);
  judge(Mode::kFault);
  EXPECT_EQ(pass(wanted).blind_joints(), 1u << 4);
  for (int n = 0; n < 4000; ++n) judge(Mode::kFault);
  EXPECT_EQ(pass(wanted).blind_joints(), 1u << 4);
  EXPECT_EQ(state.faults, fault_bit(Fault::kEmergencyStop));
}

TEST_F(SafetyGateTest, AJointInDampingWhoseEncoderFreezesIsAFaultUnlessItRests) {
  sensors.joints.velocity_radps.fill(0.02);  // at rest, by a coarse drive
  for (int n = 0; n < 4000; ++n) ASSERT_EQ(judge(Mode::kDamping), 0u);
  sensors.joints.velocity_radps[4] = 3.0;
  for (int n = 0; n < 7; ++n) ASSERT_EQ(judge(Mode::kDamping), 0u);  // less than 0.005 rad
  EXPECT_EQ(judge(Mode::kDamping), fault_bit(Fault::kEncoderFrozen));
  EXPECT_EQ(pass(wanted).blind_joints(), 1u << 4);
}

TEST_F(SafetyGateTest, AnEncoderThatFreezesInStandIsAFaultOnceTheJointIsToldToMove) {
  sensors.joints.velocity_radps.fill(0.02);  // at rest, by a coarse drive
  wanted.kp_nmprad.fill(100.0);
  for (int n = 0; n < 4000; ++n) ASSERT_EQ(stand_at(0.6), 0u);
  double target_rad = 0.6;
  std::uint64_t found = 0;
  while (found == 0 && target_rad < 2.0) found = stand_at(target_rad += 1e-3);
  EXPECT_EQ(found, fault_bit(Fault::kEncoderFrozen));
  const double later_rad = 1e-3 * static_cast<double>(config.frozen_ticks);
  EXPECT_NEAR(target_rad, 0.6 + config.frozen_commanded_rad + later_rad, 0.01);
}

TEST_F(SafetyGateTest, AJointThatHasRestedForLongHasTimeToFollowATargetThatMovesAtOnce) {
  for (int n = 0; n < 4000; ++n) ASSERT_EQ(stand_at(0.6), 0u);
  for (std::uint64_t n = 0; n < config.frozen_ticks; ++n) ASSERT_EQ(stand_at(1.2), 0u) << n;
  EXPECT_EQ(stand_at(1.2), fault_bit(Fault::kEncoderFrozen));
}

TEST_F(SafetyGateTest, OneJointMayRestWhileTheOthersAndTheBodyMove) {
  sensors.imu.angular_velocity_radps = {0.0, 0.0, 0.0};
  const auto stand = [&](int resting) {
    for (int j = resting; j < kNumJoints; ++j) {
      sensors.joints.position_rad[j] += sensors.tick % 2 == 0 ? 1e-4 : -1e-4;
    }
    // To and fro, as an attitude that stays behind is a fault.
    sensors.imu.angular_velocity_radps[0] = sensors.tick % 2 == 0 ? 1.0 : -1.0;
    return judge(Mode::kStand);
  };
  for (int n = 0; n < 4000; ++n) {
    pass_and_follow();
    ASSERT_EQ(stand(kNumJoints - 1), 0u) << n;
  }
  std::uint64_t found = 0;
  for (int n = 0; n < 1000 && found == 0; ++n) found = stand(kNumJoints);
  EXPECT_EQ(found, fault_bit(Fault::kEncoderFrozen));
}

TEST_F(SafetyGateTest, AnAttitudeThatIsSentWithEveryTenthSampleMayBeLostOnce) {
  trembles = false;
  config.imu_attitude_samples = 10;
  const SafetyGate rare(config, {2.0, 2.0, 2.0});
  const auto stand = [&] {
    sensors.imu.angular_velocity_radps[2] = sensors.tick % 2 == 0 ? 1e-6 : -1e-6;
    sensors.imu.linear_acceleration_mps2[2] = kGravity_mps2 + sensors.imu.angular_velocity_radps[2];
    pass_and_follow();
    return judge(rare, Mode::kStand);
  };
  for (int n = 0; n < 28; ++n) ASSERT_EQ(stand(), 0u) << n;
  EXPECT_EQ(stand(), fault_bit(Fault::kImuFrozen));
}

TEST_F(SafetyGateTest, WhatIsFoundAfterAStallIsTheStallsDoing) {
  judge(Mode::kWalk);
  stall(config.stall_fault_ticks + 1);
  sensors.joints.velocity_radps[2] = 2.0 * config.speed_fault_radps[2];
  EXPECT_EQ(judge(Mode::kWalk), fault_bit(Fault::kLoopStalled) | fault_bit(Fault::kJointSpeed));
  EXPECT_EQ(state.first_fault, Fault::kLoopStalled);
}

// No reset ends it, so an operator is to read its name.
TEST_F(SafetyGateTest, DrivesThatWereCutComeBeforeTheStallThatLedToIt) {
  judge(Mode::kWalk);
  stall(config.stall_fault_ticks + 1);
  sensors.drives_cut = 1;
  EXPECT_EQ(judge(Mode::kWalk), fault_bit(Fault::kLoopStalled) | fault_bit(Fault::kDrivesCut));
  EXPECT_EQ(state.first_fault, Fault::kDrivesCut);
}

double torque_of(const SafeCommand& command, const JointState& joints, int j) {
  const JointCommand& c = command.joints();
  return joint_torque(joints.position_rad[j], joints.velocity_radps[j], c.position_rad[j],
                      c.velocity_radps[j], c.kp_nmprad[j], c.kd_nmsprad[j], c.feedforward_nm[j]);
}

TEST_F(SafetyGateTest, AStallOfTicksInManyPiecesIsAFaultUnlessTheLoopRanAsLong) {
  const auto after = [&](std::uint64_t ran, std::uint64_t missed) {
    for (std::uint64_t n = 0; n < ran; ++n) EXPECT_EQ(judge(Mode::kStand), 0u);
    stall(missed);
    return judge(Mode::kStand);
  };
  judge(Mode::kStand);
  for (int n = 0; n < 20; ++n) ASSERT_EQ(after(100, 100), 0u) << n;
  EXPECT_EQ(after(90, 100), 0u);
  EXPECT_EQ(after(90, 100), 0u);
  EXPECT_EQ(after(90, 100), fault_bit(Fault::kLoopStalled));
}

TEST_F(SafetyGateTest, WhatTheLoopMissedInPassiveIsSoonOver) {
  judge(Mode::kPassive);
  stall(100'000);
  EXPECT_EQ(judge(Mode::kPassive), 0u);
  EXPECT_EQ(judge(Mode::kPassive), 0u);
  for (int n = 0; n < 10; ++n) EXPECT_EQ(judge(Mode::kStandUp), 0u);
}

TEST_F(SafetyGateTest, TheDampingOfAFaultGivesAtMostTheJointsLimit) {
  sensors.emergency_stop = 1;
  sensors.joints.velocity_radps[3] = -0.9 * config.speed_fault_radps[0];
  sensors.joints.velocity_radps[4] = 1.0;
  config.torque_limit_nm.fill(5.0);
  gate = SafetyGate(config, {2.0, 2.0, 2.0});
  judge(Mode::kStand);
  const SafeCommand passed = pass(wanted);
  EXPECT_NEAR(torque_of(passed, sensors.joints, 3), 5.0, 1e-9);
  EXPECT_EQ(torque_of(passed, sensors.joints, 4), -2.0);
}

TEST_F(SafetyGateTest, PassesACommandWithinLimitsUnchanged) {
  wanted.velocity_radps.fill(25.0);
  wanted.feedforward_nm.fill(30.0);  // and 25 N m of damping
  const SafeCommand passed = pass(wanted);
  EXPECT_TRUE(passed.enabled());
  EXPECT_EQ(passed.joints().position_rad, wanted.position_rad);
  EXPECT_EQ(passed.joints().velocity_radps, wanted.velocity_radps);
  EXPECT_EQ(passed.joints().kp_nmprad, wanted.kp_nmprad);
  EXPECT_EQ(passed.joints().kd_nmsprad, wanted.kd_nmsprad);
  EXPECT_EQ(passed.joints().feedforward_nm, wanted.feedforward_nm);
  for (const auto& [name, ticks] : kGateCounters) EXPECT_EQ(state.counters.*ticks, 0u) << name;
}

TEST_F(SafetyGateTest, ClampsAndCountsCommandedPositions) {
  wanted.kp_nmprad.fill(10.0);
  wanted.position_rad[2] = 5.0;
  wanted.position_rad[5] = -5.0;
  const SafeCommand passed = pass(wanted);
  EXPECT_EQ(passed.joints().position_rad[2], 1.0);
  EXPECT_EQ(passed.joints().position_rad[5], -2.5 - 1.0);
  EXPECT_EQ(state.counters.position_clamped, 1u);  // ticks, not joints
}

TEST_F(SafetyGateTest, ATargetMovesByTwoRadiansAtMostInATick) {
  wanted.kp_nmprad.fill(10.0);
  wanted.position_rad[1] = -2.0;
  EXPECT_EQ(pass(wanted).joints().position_rad[1], -2.0);  // nothing was commanded before
  wanted.position_rad[1] = 3.0;
  EXPECT_EQ(pass(wanted).joints().position_rad[1], 0.0);
  EXPECT_EQ(pass(wanted).joints().position_rad[1], 2.0);
  EXPECT_EQ(pass(wanted).joints().position_rad[1], 3.0);
  EXPECT_EQ(state.counters.position_clamped, 2u);
}

TEST_F(SafetyGateTest, ClampsAndCountsCommandedVelocities) {
  wanted.velocity_radps[0] = 30.0;
  EXPECT_EQ(pass(wanted).joints().velocity_radps[0], 25.0);
  EXPECT_EQ(state.counters.velocity_clamped, 1u);
}

TEST_F(SafetyGateTest, AJointCommandGivesNoMoreThanTheJointsTorqueHoweverItAsks) {
  for (const auto part : {&JointCommand::position_rad, &JointCommand::feedforward_nm}) {
    for (const double sign : {1.0, -1.0}) {
      state = {};
      JointCommand strong = wanted;
      (strong.*part)[4] += sign * 200.0;
      const SafeCommand passed = pass(strong);
      EXPECT_NEAR(torque_of(passed, sensors.joints, 4), sign * 60.0, 1e-9);
      EXPECT_EQ(passed.joints().position_rad[3], wanted.position_rad[3]);
      EXPECT_EQ(state.counters.torque_clamped, 1u);
    }
  }
}

TEST_F(SafetyGateTest, ACommandWithoutStiffnessIsWeakenedAndStaysDamping) {
  JointCommand damping;
  damping.kd_nmsprad.fill(4.0);
  sensors.joints.velocity_radps[4] = 30.0;
  const SafeCommand passed = pass(damping);
  EXPECT_NEAR(torque_of(passed, sensors.joints, 4), -60.0, 1e-9);
  EXPECT_TRUE(only_brakes(passed));
}

TEST_F(SafetyGateTest, GainsStayWithinTheRobotsRange) {
  wanted.kp_nmprad[1] = 1e300;
  wanted.kp_nmprad[2] = -1.0;
  wanted.kd_nmsprad[3] = 1e300;
  const SafeCommand passed = pass(wanted);
  EXPECT_EQ(passed.joints().kp_nmprad[1], 200.0);
  EXPECT_EQ(passed.joints().kp_nmprad[2], 0.0);
  EXPECT_EQ(passed.joints().kd_nmsprad[3], 5.0);
  EXPECT_EQ(state.counters.gains_clamped, 1u);
}

TEST_F(SafetyGateTest, PowerIsBoundedByWeakeningWhatDrivesAndNotWhatBrakes) {
  sensors.joints.velocity_radps.fill(20.0);
  wanted.kd_nmsprad.fill(0.0);
  for (int j = 0; j < kNumJoints; ++j) wanted.position_rad[j] += j == 7 ? -0.5 : 0.5;
  const SafeCommand passed = pass(wanted);  // 11 x 50 N m x 20 rad/s = 11 kW
  double power_w = 0.0;
  for (int j = 0; j < kNumJoints; ++j) {
    power_w += std::max(torque_of(passed, sensors.joints, j) * 20.0, 0.0);
  }
  EXPECT_NEAR(power_w, 8000.0, 1e-6);
  EXPECT_NEAR(torque_of(passed, sensors.joints, 7), -50.0, 1e-9);
  EXPECT_EQ(state.counters.power_clamped, 1u);
}

TEST_F(SafetyGateTest, NoSettingPutsAThresholdBeyondItsCeiling) {
  config.tilt_fault_deg = 180.0;
  config.joints_fault_ticks = 1'000'000;
  config.kp_limit_nmprad = 1e300;
  const SafetyGate loose(config, {2.0, 2.0, 2.0});
  tilt(80.1);
  EXPECT_EQ(judge(loose, Mode::kStand), fault_bit(Fault::kTilt));
  state = {};
  tilt(0.0);
  stamp(100, 100 - 41, 100);
  EXPECT_EQ(judge(loose, Mode::kStand), fault_bit(Fault::kJointsStale));
  state = {};
  wanted.kp_nmprad.fill(1e6);
  EXPECT_EQ(loose.pass(wanted, true, sensors.joints, state).joints().kp_nmprad[0], 1000.0);
}

TEST(GateConfigTest, EveryThresholdIsBoundedByItsCeilingAndItsDefaultIsWithin) {
  const auto check = [](const auto& threshold) {
    GateConfig config;
    EXPECT_LE(config.*threshold.value, threshold.ceiling) << threshold.ceiling;
    config.*threshold.value = threshold.ceiling * 2;
    EXPECT_EQ(below_ceilings(config).*threshold.value, threshold.ceiling);
    config.*threshold.value = threshold.least;
    EXPECT_EQ(below_ceilings(config).*threshold.value, threshold.least);
  };
  for (const auto& threshold : kGateThresholds) check(threshold);
  for (const auto& threshold : kGateTickThresholds) check(threshold);
  for (const auto& threshold : kGateJointThresholds) {
    GateConfig config;
    config.*threshold.value = {0.0, threshold.ceiling * 2, threshold.ceiling / 2};
    EXPECT_EQ(below_ceilings(config).*threshold.value,
              (LegJoints<double>{0.0, threshold.ceiling, threshold.ceiling / 2}));
  }
}

TEST_F(SafetyGateTest, EachJointOfALegHasItsOwnSpeedAndItsOwnContinuousTorque) {
  config.speed_fault_radps = {60.0, 60.0, 30.0};
  config.continuous_torque_nm = {10.0, 10.0, 20.0};
  config.thermal_time_s = 0.001;
  gate = SafetyGate(config, {2.0, 2.0, 2.0});
  sensors.joints.velocity_radps[4] = sensors.joints.velocity_radps[5] = 35.0;
  sensors.joints.torque_nm[8] = 15.0;
  EXPECT_EQ(judge(Mode::kWalk), fault_bit(Fault::kJointSpeed));
  EXPECT_EQ(state.fault_joints, std::uint64_t{1} << 5);
  state = {};
  sensors.joints.velocity_radps.fill(0.0);
  std::uint64_t found = 0;
  for (int n = 0; n < 10 && found == 0; ++n) found = judge(Mode::kWalk);
  EXPECT_EQ(found, 0u);
  sensors.joints.torque_nm[7] = 15.0;
  for (int n = 0; n < 10 && found == 0; ++n) found = judge(Mode::kWalk);
  EXPECT_EQ(found, fault_bit(Fault::kOverload));
  EXPECT_EQ(state.fault_joints, std::uint64_t{1} << 7);
}

TEST_F(SafetyGateTest, CommandThatIsNotFiniteBecomesDampingAndLatches) {
  for (auto part :
       {&JointCommand::position_rad, &JointCommand::velocity_radps, &JointCommand::kp_nmprad,
        &JointCommand::kd_nmsprad, &JointCommand::feedforward_nm}) {
    for (const double bad : {kNan, kInf, -kInf}) {
      state = {};
      JointCommand broken = wanted;
      (broken.*part)[7] = bad;
      const SafeCommand passed = pass(broken);
      EXPECT_TRUE(passed.enabled());
      EXPECT_TRUE(only_brakes(passed));
      EXPECT_EQ(passed.joints().kd_nmsprad[7], 2.0);
      EXPECT_EQ(state.first_fault, Fault::kNonFiniteOutput);
    }
  }
}

TEST_F(SafetyGateTest, NothingButDampingPassesWhileLatched) {
  sensors.joints.velocity_radps[3] = 61.0;
  EXPECT_NE(judge(Mode::kStand), 0u);
  sensors.joints.velocity_radps[3] = 0.0;
  EXPECT_EQ(judge(Mode::kFault), 0u);
  EXPECT_TRUE(only_brakes(pass(wanted)));
  EXPECT_FALSE(pass(wanted, false).enabled());
  gate.clear(state);
  EXPECT_FALSE(only_brakes(pass(wanted)));
}

TEST_F(SafetyGateTest, LimitsAreCountedWithoutAFault) {
  sensors.joints.position_rad[2] = 0.35;
  sensors.joints.position_rad[5] = 0.1;
  sensors.joints.velocity_radps[4] = -60.0;
  tilt(59.999);
  stamp(40, 40 - 8, 0);
  EXPECT_EQ(judge(Mode::kWalk), 0u);
  EXPECT_EQ(state.counters.joint_past_stop, 1u);
  EXPECT_EQ(state.counters.joint_too_fast, 1u);
  EXPECT_EQ(state.counters.tilted, 1u);
  EXPECT_EQ(state.counters.joints_late, 1u);
  EXPECT_EQ(state.counters.imu_late, 1u);
  EXPECT_EQ(state.faults, 0u);
}

TEST_F(SafetyGateTest, NothingIsCountedWithinLimits) {
  sensors.joints.position_rad[2] = 0.0;
  sensors.joints.velocity_radps[4] = 25.0;
  tilt(44.999);
  stamp(10, 8, 2);
  EXPECT_EQ(judge(Mode::kWalk), 0u);
  EXPECT_EQ(state.counters.joint_past_stop + state.counters.joint_too_fast + state.counters.tilted +
                state.counters.joints_late + state.counters.imu_late,
            0u);
}

TEST_F(SafetyGateTest, TiltIsJudgedOnlyWhereTheRobotCarriesItself) {
  trembles = false;
  tilt(60.001);
  EXPECT_EQ(judge(Mode::kDamping), 0u);
  EXPECT_EQ(judge(Mode::kPassive), 0u);
  for (const Mode mode : {Mode::kStandUp, Mode::kStand, Mode::kWalk}) {
    EXPECT_EQ(judge(mode), fault_bit(Fault::kTilt));
  }
  state = {};
  tilt(179.0);
  EXPECT_EQ(judge(Mode::kStand), fault_bit(Fault::kTilt));
}

TEST_F(SafetyGateTest, TiltThresholdMatchesItsAngle) {
  trembles = false;
  for (int angle_deg = 5; angle_deg <= 80; angle_deg += 5) {
    config.tilt_fault_deg = angle_deg;
    const SafetyGate other(config, {2.0, 2.0, 2.0});
    state = {};
    tilt(angle_deg - 1e-6);
    EXPECT_EQ(judge(other, Mode::kStand), 0u) << angle_deg;
    tilt(angle_deg + 1e-6);
    EXPECT_NE(judge(other, Mode::kStand), 0u) << angle_deg;
  }
}

TEST_F(SafetyGateTest, TorqueFaultNeedsTwentySamplesOfOneJointInARow) {
  const auto sample = [&](int joint, double torque_nm) {
    sensors.joints.torque_nm = {};
    sensors.joints.torque_nm[joint] = torque_nm;
    return judge(Mode::kWalk);
  };
  for (int n = 0; n < 19; ++n) EXPECT_EQ(sample(2, -77.0), 0u);
  EXPECT_EQ(sample(2, 72.0), 0u);  // 1.2 * 60
  for (int n = 0; n < 100; ++n) EXPECT_EQ(sample(n % 2, 77.0), 0u);
  for (int n = 0; n < 19; ++n) EXPECT_EQ(sample(8, 77.0), 0u);
  EXPECT_EQ(sample(8, 77.0), fault_bit(Fault::kJointTorque));
}

TEST_F(SafetyGateTest, EachJointIsJudgedByItsOwnLimits) {
  config.torque_limit_nm[2] = 30.0;
  config.speed_limit_radps[4] = 10.0;
  const SafetyGate other(config, {2.0, 2.0, 2.0});
  wanted.feedforward_nm[2] = wanted.feedforward_nm[1] = 50.0;
  const SafeCommand passed = other.pass(wanted, true, sensors.joints, state);
  EXPECT_NEAR(torque_of(passed, sensors.joints, 2), 30.0, 1e-9);
  EXPECT_NEAR(torque_of(passed, sensors.joints, 1), 50.0, 1e-9);
  sensors.joints.velocity_radps[3] = sensors.joints.velocity_radps[5] = 11.0;
  judge(other, Mode::kStand);
  EXPECT_EQ(state.counters.joint_too_fast, 0u);
  sensors.joints.velocity_radps[4] = 11.0;
  judge(other, Mode::kStand);
  EXPECT_EQ(state.counters.joint_too_fast, 1u);
  sensors.joints.velocity_radps = {};  // a joint that moves and has the same bits is another fault
  sensors.joints.torque_nm[1] = sensors.joints.torque_nm[3] = 40.0;
  for (int n = 0; n < 40; ++n) {
    EXPECT_EQ(judge(other, Mode::kStand), 0u);
  }
  sensors.joints.torque_nm[2] = 40.0;
  for (int n = 0; n < 20; ++n) judge(other, Mode::kStand);
  EXPECT_EQ(state.faults, fault_bit(Fault::kJointTorque));
}

TEST_F(SafetyGateTest, SilentDriveIsToldFromAllTheOthers) {
  stamp(100, 100, 100);
  sensors.joints.tick[7] = 100 - config.joints_fault_ticks - 1;
  EXPECT_EQ(judge(Mode::kPassive), fault_bit(Fault::kJointsStale));
  EXPECT_EQ(state.fault_joints, std::uint64_t{1} << 7);
  EXPECT_EQ(state.counters.joints_late, 1u);
}

TEST_F(SafetyGateTest, FaultOfADriveIsAFaultInEveryModeAndNamesItsJoint) {
  for (const Mode mode : {Mode::kPassive, Mode::kDamping, Mode::kStand, Mode::kWalk}) {
    state = {};
    sensors.joints.drive_fault = {};
    EXPECT_EQ(judge(mode), 0u);
    sensors.joints.drive_fault[2] = 33;
    sensors.joints.drive_fault[10] = 1;
    EXPECT_EQ(judge(mode), fault_bit(Fault::kDriveFault));
    EXPECT_EQ(state.first_fault, Fault::kDriveFault);
    EXPECT_EQ(state.fault_joints, std::uint64_t{1} << 2 | std::uint64_t{1} << 10);
  }
}

TEST_F(SafetyGateTest, ForeignTrafficIsAFaultInEveryModeAndNamesItsJoint) {
  for (const Mode mode : {Mode::kPassive, Mode::kDamping, Mode::kStand, Mode::kWalk}) {
    state = {};
    sensors.foreign_traffic = 1u << 7;
    EXPECT_EQ(judge(mode), fault_bit(Fault::kForeignTraffic));
    EXPECT_EQ(state.fault_joints, std::uint64_t{1} << 7);
  }
}

TEST_F(SafetyGateTest, EveryJointAtFaultIsNamedUntilTheNextLatch) {
  sensors.joints.velocity_radps[4] = kNan;
  judge(Mode::kWalk);
  sensors.joints.velocity_radps[4] = 0.0;
  sensors.joints.velocity_radps[9] = 1e3;
  judge(Mode::kWalk);
  EXPECT_EQ(state.fault_joints, std::uint64_t{1} << 4 | std::uint64_t{1} << 9);
  gate.clear(state);
  EXPECT_EQ(state.fault_joints, std::uint64_t{1} << 4 | std::uint64_t{1} << 9);
  sensors.joints.velocity_radps[9] = 0.0;
  sensors.joints.drive_fault[0] = 5;
  judge(Mode::kWalk);
  EXPECT_EQ(state.fault_joints, 1u);
}

TEST_F(SafetyGateTest, SampleFromTheFutureIsStale) {
  stamp(100, 101, 101);
  const std::uint64_t found = judge(Mode::kPassive);
  EXPECT_EQ(found, fault_bit(Fault::kJointsStale) | fault_bit(Fault::kImuStale));
  EXPECT_EQ(state.first_fault, Fault::kJointsStale);
  EXPECT_EQ(state.first_fault_tick, 100u);
}

TEST_F(SafetyGateTest, QuaternionThatIsNoRotationIsUnusable) {
  sensors.imu.orientation_wxyz = {0.0, 0.0, 0.0, 0.0};
  EXPECT_EQ(judge(Mode::kStand), fault_bit(Fault::kNonFiniteImu));
  sensors.imu.orientation_wxyz = {1e200, 1e200, 0.0, 0.0};
  EXPECT_EQ(judge(Mode::kStand), fault_bit(Fault::kNonFiniteImu));
}

TEST(FaultTest, NamesAreStable) {
  const char* expected[kNumFaults] = {
      "non_finite_joint",  "non_finite_imu", "non_finite_action", "non_finite_command",
      "non_finite_output", "joints_stale",   "imu_stale",         "policy_stale",
      "joint_position",    "joint_speed",    "joint_torque",      "tilt",
      "drive_fault",       "emergency_stop", "drives_cut",        "time",
      "loop_stalled",      "encoder_jump",   "encoder_frozen",    "policy_frozen",
      "overload",          "free_fall",      "not_standing",      "imu_frozen",
      "imu_range",         "imu_attitude",   "imu_gyro",          "torque_missing",
      "not_following",     "speed_mismatch", "joint_misplaced",   "foreign_traffic"};
  for (int i = 0; i < kNumFaults; ++i) {
    EXPECT_STREQ(fault_name(static_cast<Fault>(1u << i)), expected[i]);
  }
  EXPECT_STREQ(fault_name(Fault::kNone), "none");
  EXPECT_STREQ(fault_name(static_cast<Fault>(std::uint64_t{1} << 40)), "unknown");
}

TEST(TicksFromSecondsTest, RoundsAndBoundsInvalidValues) {
  EXPECT_EQ(ticks_from_s(0.005), 20u);
  EXPECT_EQ(ticks_from_s(1.5), 6000u);
  EXPECT_EQ(ticks_from_s(-1.0), 0u);
  EXPECT_EQ(ticks_from_s(kNan), 0u);
  EXPECT_EQ(ticks_from_s(kInf), std::uint64_t{1} << 62);
}

}  // namespace
}  // namespace sandrunner
