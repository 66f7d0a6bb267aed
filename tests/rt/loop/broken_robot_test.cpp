// SPDX-License-Identifier: BSD-3-Clause
// Sensors that are wrong in a consistent way and drives that do not do what they are commanded,
// on the simulated robot: each is a fault before it does harm.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>

#include "rt/core/rotation.h"
#include "watch.h"

namespace sandrunner {
namespace {

class BrokenRobotTest : public EveryModeTest {
 protected:
  /// Breaks the robot in `mode` and watches it for up to `duration_s`.
  Outcome outcome(Mode mode, Drives drives, const std::function<void(DisturbedLoop&)>& breaks,
                  double duration_s = 3.0) {
    DisturbedLoop loop(config, policy, drives, snapshots.at(mode));
    loop.run(0.05);
    breaks(loop);
    const Outcome seen = watch(loop, duration_s, 0.5);
    std::printf("  %-9s %-6s %-16s after %5.3f s, tilt %4.2f rad, %4.1f N m, then %4.1f rad/s\n",
                mode_name(mode), drives == Drives::kGains ? "gains" : "torque",
                fault_name(seen.fault), seen.after_s, seen.tilt_rad, seen.fault_torque_nm,
                seen.speed_radps);
    return seen;
  }

  using F = SensorFrame&;
  using G = const SensorFrame&;
  using N = std::uint64_t;
  static auto spoil(const std::function<void(F, G, N)>& how) {
    return [how](DisturbedLoop& loop) { loop.robot.spoil = how; };
  }
};

TEST_F(BrokenRobotTest, AnAttitudeThatStandsStillButForNoiseIsAFaultBeforeTheRobotFalls) {
  const auto frozen = spoil([](F f, G good, N n) {
    f.imu.orientation_wxyz = good.imu.orientation_wxyz;
    f.imu.orientation_wxyz[1] += n % 2 == 0 ? 1e-6 : -1e-6;
  });
  const Outcome seen = outcome(Mode::kWalk, Drives::kGains, frozen, 10.0);
  EXPECT_TRUE(seen.fault == Fault::kImuGyro || seen.fault == Fault::kImuAttitude);
  EXPECT_LT(seen.tilt_rad, 0.6);
}

TEST_F(BrokenRobotTest, AGyroscopeInDegreesIsAFaultBeforeTheRobotFalls) {
  const Outcome seen = outcome(Mode::kWalk, Drives::kGains, spoil([](F f, G, N) {
                                 for (double& w : f.imu.angular_velocity_radps) w *= 57.3;
                               }));
  EXPECT_TRUE(seen.fault == Fault::kImuGyro || seen.fault == Fault::kImuRange);
  EXPECT_LT(seen.tilt_rad, 0.2);
}

TEST_F(BrokenRobotTest, ADriveWithoutTorqueIsAFaultByItsOwnName) {
  for (const Mode mode : {Mode::kStand, Mode::kWalk}) {
    for (const Drives drives : {Drives::kGains, Drives::kTorque}) {
      for (int joint = 0; joint < kNumJoints; ++joint) {
        const auto limp = [joint](DisturbedLoop& loop) {
          loop.robot.limp = std::uint64_t{1} << joint;
        };
        const Outcome seen = outcome(mode, drives, limp, 8.0);
        // In Stand the knees alone bear a load; what the others lack is not commanded either.
        const bool bears = mode == Mode::kWalk || joint % kJointsPerLeg == 2;
        EXPECT_EQ(seen.fault, bears ? Fault::kTorqueMissing : Fault::kNone) << "joint " << joint;
        EXPECT_LT(seen.tilt_rad, 0.15) << "joint " << joint;
      }
    }
  }
}

TEST_F(BrokenRobotTest, ADriveWhoseTorqueHasTheWrongSignIsStoppedBeforeItIsFast) {
  for (int joint = 0; joint < kJointsPerLeg; ++joint) {
    const auto inverted = [joint](DisturbedLoop& loop) {
      loop.robot.inverted = std::uint64_t{1} << joint;
      loop.ask(ModeRequest::kStand);
    };
    const Outcome seen = outcome(Mode::kDamping, Drives::kGains, inverted);
    EXPECT_NE(seen.fault, Fault::kNone) << "joint " << joint;
    EXPECT_LT(seen.speed_radps, 30.0) << "joint " << joint;
  }
}

TEST_F(BrokenRobotTest, AJointThatIsHeldInStandUpIsAFaultAndNotPressedWithAllTorque) {
  for (const double gain_ramp_s : {0.0, 2.0}) {
    config.controller.stand.gain_ramp_s = gain_ramp_s;
    const Outcome seen = outcome(
        Mode::kDamping, Drives::kGains,
        [](DisturbedLoop& loop) {
          const JointArray<double> at_rad = loop.simulator.state().robot.rigid.q;
          loop.hand = hold(1u << 2, all_joints(-10.0), at_rad);
          loop.ask(ModeRequest::kStand);
        },
        6.0);
    EXPECT_EQ(seen.fault, Fault::kNotFollowing);
    EXPECT_LE(seen.fault_torque_nm, 0.65 * config.robot.model.torque_limit_nm[2] + 1e-9);
  }
}

TEST_F(BrokenRobotTest, AJointThatIsHeldAsTheRobotLiesDownIsAFault) {
  const Outcome seen = outcome(
      Mode::kStand, Drives::kGains,
      [](DisturbedLoop& loop) {
        hold(loop, 1u << 2);
        loop.ask(ModeRequest::kLie);
      },
      6.0);
  EXPECT_EQ(seen.fault, Fault::kNotFollowing);
}

TEST_F(BrokenRobotTest, AJointThatIsHeldInWalkIsAFault) {
  for (const int joint : {1, 2, 11}) {
    const Outcome seen = outcome(
        Mode::kWalk, Drives::kGains, [&](DisturbedLoop& loop) { hold(loop, 1u << joint); }, 5.0);
    EXPECT_EQ(seen.fault, Fault::kNotFollowing) << "joint " << joint;
    EXPECT_LT(seen.tilt_rad, 0.3) << "joint " << joint;
  }
}

TEST_F(BrokenRobotTest, ALiftedRobotEndsItsWalkWithoutAFault) {
  DisturbedLoop loop(config, policy, Drives::kGains, snapshots.at(Mode::kWalk));
  lift(loop);
  loop.run(1.5);
  EXPECT_EQ(loop.record.output.warnings, warning_bit(Warning::kLifted));
  loop.run(4.0);
  EXPECT_EQ(loop.record.output.mode, Mode::kDamping);
  EXPECT_EQ(loop.record.output.faults, 0u);
}

TEST_F(BrokenRobotTest, AnEncoderThatIsStuckButForACountIsAFault) {
  for (int joint = 0; joint < kJointsPerLeg; ++joint) {
    const auto stuck = spoil([joint](F f, G good, N n) {
      f.joints.position_rad[joint] =
          good.joints.position_rad[joint] + (n / 7 % 2 == 0 ? 0.0 : 0.0004);
      f.joints.velocity_radps[joint] = n % 2 == 0 ? 0.01 : -0.01;
    });
    const Outcome seen = outcome(Mode::kWalk, Drives::kGains, stuck, 5.0);
    // Hip abduction that hardly moves is not missed.
    EXPECT_EQ(seen.fault == Fault::kNone, joint == 0) << "joint " << joint;
    EXPECT_LT(seen.tilt_rad, 0.1) << "joint " << joint;
  }
}

TEST_F(BrokenRobotTest, ASpeedThatDoesNotFitThePositionIsAFault) {
  for (const double scale : {-1.0, 0.0}) {
    const auto wrong = spoil([scale](F f, G, N) { f.joints.velocity_radps[2] *= scale; });
    const Outcome seen = outcome(Mode::kWalk, Drives::kGains, wrong, 5.0);
    EXPECT_EQ(seen.fault, Fault::kSpeedMismatch) << scale;
    EXPECT_LT(seen.tilt_rad, 0.5) << scale;
  }
}

TEST_F(BrokenRobotTest, TorqueDrivesWhoseEncodersFreezeAtRestAreAFaultWhenTheBodyMoves) {
  const auto freeze = [](std::uint64_t joints) {
    return spoil([joints](F f, G good, N) {
      for (int j = 0; j < kNumJoints; ++j) {
        if ((joints >> j & 1) == 0) continue;
        f.joints.position_rad[j] = good.joints.position_rad[j];
        f.joints.velocity_radps[j] = 0.01;
      }
    });
  };
  const Outcome all = outcome(Mode::kStand, Drives::kTorque, freeze(0xfff), 15.0);
  EXPECT_EQ(all.fault, Fault::kEncoderFrozen);
  EXPECT_LT(all.tilt_rad, 0.3);
}

/// Switches the supply off for 3 s in Stand, and on again; the joint comes back by `offset_rad`.
Fault after_supply_cut(const ProcessConfig& config, const Policy& policy, const Snapshot& stand,
                       int joint, double offset_rad) {
  DisturbedLoop loop(config, policy, Drives::kGains, stand);
  bool cut = true;
  loop.robot.spoil = [&](SensorFrame& f, const SensorFrame& good, std::uint64_t) {
    if (cut) {
      f.joints = good.joints;
    } else {
      f.joints.position_rad[joint] += offset_rad;
    }
  };
  loop.run(3.0);
  cut = false;
  loop.run(0.5);
  loop.ask(ModeRequest::kResetFault);
  loop.run(0.1);
  loop.ask(ModeRequest::kArm);
  loop.run(0.1);
  return loop.fault();
}

TEST_F(BrokenRobotTest, AJointThatComesBackAMotorTurnAwayIsNotArmed) {
  constexpr double kMotorTurn_rad = 2.0 * 3.14159265358979 / 6.75;
  for (const double turn_rad : {-kMotorTurn_rad, kMotorTurn_rad}) {
    for (int joint = 0; joint < kJointsPerLeg; ++joint) {
      const Fault seen =
          after_supply_cut(config, policy, snapshots.at(Mode::kStand), joint, turn_rad);
      // A knee may be past its stop, which is a fault at once.
      EXPECT_TRUE(seen == Fault::kJointMisplaced || (joint == 2 && seen != Fault::kNone))
          << fault_name(seen) << ", joint " << joint << " by " << turn_rad;
    }
  }
}

/// Starts the lying robot with a joint that is off by `offset_rad`, and arms it.
Fault armed_with(const ProcessConfig& config, const Policy& policy, int joint, double offset_rad) {
  DisturbedLoop loop(config, policy, Drives::kGains);
  loop.robot.spoil = [&](SensorFrame& f, const SensorFrame&, std::uint64_t) {
    f.joints.position_rad[joint] += offset_rad;
  };
  loop.run(0.1);
  loop.ask(ModeRequest::kArm);
  loop.run(0.1);
  return loop.fault();
}

TEST_F(BrokenRobotTest, ARobotThatStartsIsArmedOnlyInTheLyingPose) {
  for (int joint = 0; joint < kJointsPerLeg; ++joint) {
    EXPECT_EQ(armed_with(config, policy, joint, 0.0), Fault::kNone);
    EXPECT_EQ(armed_with(config, policy, joint, 0.93), Fault::kJointMisplaced) << joint;
    EXPECT_NE(armed_with(config, policy, joint, -0.93), Fault::kNone) << joint;
    ProcessConfig hanging = config;
    hanging.controller.gate.hanging = true;
    EXPECT_EQ(armed_with(hanging, policy, joint, 0.93), Fault::kNone) << joint;
  }
}

TEST_F(BrokenRobotTest, AnAbsurdTorqueDoesNotSwitchTheOverloadOff) {
  DisturbedLoop loop(config, policy, Drives::kGains, snapshots.at(Mode::kStand));
  bool absurd = true;
  loop.robot.spoil = [&](SensorFrame& f, const SensorFrame&, std::uint64_t) {
    f.joints.torque_nm[4] = absurd ? 1e160 : 0.0;
  };
  loop.step();
  absurd = false;
  loop.run(30.0);
  const double heat_n2m2 = loop.loop.controller().state().gate.heat_n2m2[4];
  EXPECT_GE(heat_n2m2, 0.0);
  EXPECT_LT(heat_n2m2, 30.0);  // forgotten
}

}  // namespace
}  // namespace sandrunner
