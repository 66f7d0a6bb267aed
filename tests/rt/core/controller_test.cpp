// SPDX-License-Identifier: BSD-3-Clause
// Modes, standing up, stopping, snapshots. Walk's policy and command are in walk_test.cpp.
#include "rt/core/controller.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "fake_robot.h"
#include "rt/core/state_hash.h"

namespace sandrunner {
namespace {

TEST(ControllerTest, StartsPassiveWithDrivesOff) {
  FakeLoop loop;
  for (int n = 0; n < 100; ++n) {
    loop.tick();
    ASSERT_EQ(loop.output.mode, Mode::kPassive);
    ASSERT_FALSE(loop.output.command.enabled());
  }
}

TEST(ControllerTest, NothingMovesWithoutTheFiguresOfARobot) {
  for (const Mode mode : {Mode::kDamping, Mode::kStandUp, Mode::kStand, Mode::kWalk}) {
    FakeLoop loop(Mode::kPassive, ControllerConfig{});
    loop.robot.now.joints.position_rad = {};
    loop.reach(mode);
    EXPECT_EQ(loop.output.mode, mode);
    const JointCommand& command = loop.output.command.joints();
    EXPECT_EQ(command.kp_nmprad, JointArray<double>{});
    EXPECT_EQ(command.kd_nmsprad, JointArray<double>{});
    EXPECT_EQ(command.feedforward_nm, JointArray<double>{});
    loop.robot.now.joints.velocity_radps[3] = 0.1;
    loop.tick();
    EXPECT_EQ(loop.controller.state().gate.first_fault, Fault::kJointSpeed);
  }
}

TEST(ControllerTest, RequestCountsOnceForItsId) {
  FakeLoop loop;
  loop.request(ModeRequest::kArm);
  EXPECT_EQ(loop.output.mode, Mode::kDamping);
  EXPECT_EQ(loop.output.command.joints().kd_nmsprad[4], 2.0);
  loop.request(ModeRequest::kPassive);
  loop.input.command.request = ModeRequest::kArm;  // old id
  loop.run_s(0.1);
  EXPECT_EQ(loop.output.mode, Mode::kPassive);
}

TEST(ControllerTest, DampWorksFromEveryModeThatMoves) {
  for (const Mode mode : {Mode::kStandUp, Mode::kStand, Mode::kWalk}) {
    FakeLoop loop;
    loop.reach(mode);
    loop.request(ModeRequest::kDamp);
    EXPECT_EQ(loop.output.mode, Mode::kDamping);
    EXPECT_TRUE(only_brakes(loop.output.command));
    EXPECT_TRUE(loop.output.command.enabled());
  }
}

TEST(ControllerTest, WalkIsRefusedUntilStanding) {
  FakeLoop loop;
  for (const Mode mode : {Mode::kPassive, Mode::kDamping, Mode::kStandUp}) {
    loop.reach(mode);
    loop.request(ModeRequest::kWalk);
    EXPECT_EQ(loop.output.mode, mode);
  }
  loop.run_s(3.0);
  EXPECT_EQ(loop.output.mode, Mode::kStand);  // the refused requests did not wait
}

/// Stands up from `posture_rad`, checks that targets move smoothly, returns how long it took.
double stand_up(const JointArray<double>& posture_rad, double* nearest_to_fold_rad = nullptr) {
  ControllerConfig config = test_robot();
  config.gate.lying_rad = posture_rad;
  FakeLoop loop(Mode::kPassive, config);
  loop.robot.now.joints.position_rad = posture_rad;
  loop.stand_up();
  const StandConfig& stand = loop.config.stand;
  JointCommand before = loop.output.command.joints();
  EXPECT_EQ(before.position_rad, posture_rad);  // begins where the robot is
  std::uint64_t ticks = 0;
  double nearest_rad = 100.0;
  while (loop.output.mode == Mode::kStandUp && ticks < 100000) {
    loop.tick();
    ++ticks;
    const JointCommand& now = loop.output.command.joints();
    double from_fold_rad = 0.0;
    for (int j = 0; j < kNumJoints; ++j) {
      const double step_rad = now.position_rad[j] - before.position_rad[j];
      const double mean_radps = 0.5 * (now.velocity_radps[j] + before.velocity_radps[j]);
      EXPECT_NEAR(step_rad * kControlHz, mean_radps, 1e-4);  // the speed is that of the position
      EXPECT_LE(std::fabs(now.velocity_radps[j]), stand.max_speed_radps * (1.0 + 1e-9));
      EXPECT_LE(std::fabs(now.velocity_radps[j] - before.velocity_radps[j]) * kControlHz, 30.0);
      EXPECT_EQ(now.kp_nmprad[j], 100.0);
      EXPECT_EQ(now.kd_nmsprad[j], 1.0);
      const double fold_rad = stand.fold_rad[j % kJointsPerLeg];
      from_fold_rad = std::max(from_fold_rad, std::fabs(now.position_rad[j] - fold_rad));
    }
    nearest_rad = std::min(nearest_rad, from_fold_rad);
    before = now;
  }
  EXPECT_EQ(loop.output.mode, Mode::kStand);
  EXPECT_EQ(before.position_rad, stand.nominal_rad);
  EXPECT_EQ(before.velocity_radps, JointArray<double>{});
  if (nearest_to_fold_rad != nullptr) *nearest_to_fold_rad = nearest_rad;
  return static_cast<double>(ticks) * kControlPeriod_s;
}

TEST(ControllerTest, StandsUpSmoothlyByFoldingFirst) {
  double nearest_to_fold_rad = 0.0;
  EXPECT_NEAR(stand_up(kLyingPosture_rad, &nearest_to_fold_rad), 2.5, 0.001);
  EXPECT_LT(nearest_to_fold_rad, 1e-9);
}

TEST(ControllerTest, LongWayTakesLongerInsteadOfFaster) {
  JointArray<double> posture_rad = kLyingPosture_rad;
  posture_rad[1] = -3.0;
  EXPECT_NEAR(stand_up(posture_rad), 1.875 * 4.2 / 4.0 + 1.5, 0.001);
}

TEST(ControllerTest, DoesNotFoldWhenNearlyStanding) {
  JointArray<double> posture_rad = test_robot().stand.nominal_rad;
  for (double& q : posture_rad) q += 0.29;
  double nearest_to_fold_rad = 0.0;
  EXPECT_NEAR(stand_up(posture_rad, &nearest_to_fold_rad), 1.5, 0.001);
  EXPECT_GT(nearest_to_fold_rad, 0.5);
}

/// Stiffness of a StandUp from `posture_rad` after `time_s`, with a ramp of 1.2 s.
double ramped_kp_nmprad(const JointArray<double>& posture_rad, double time_s) {
  ControllerConfig config = test_robot();
  config.stand.gain_ramp_s = 1.2;
  config.gate.lying_rad = posture_rad;
  FakeLoop loop(Mode::kPassive, config);
  loop.robot.now.joints.position_rad = posture_rad;
  loop.stand_up();
  double before_nmprad = 0.0;
  for (std::uint64_t n = ticks_from_s(time_s); n > 0; --n) {
    const JointCommand& now = loop.output.command.joints();
    EXPECT_LE(std::fabs(now.kp_nmprad[0] - before_nmprad), 100.0 / 4800.0 + 1e-9);  // no step
    EXPECT_EQ(now.kd_nmsprad[0], 1.0);
    before_nmprad = now.kp_nmprad[0];
    loop.tick();
  }
  EXPECT_EQ(loop.output.mode, Mode::kStandUp);
  return loop.output.command.joints().kp_nmprad[0];
}

TEST(ControllerTest, StiffnessRisesOverTheRampAndIsWholeInTheNextMotion) {
  EXPECT_NEAR(ramped_kp_nmprad(kLyingPosture_rad, 0.0), 0.0, 1e-12);
  EXPECT_NEAR(ramped_kp_nmprad(kLyingPosture_rad, 0.6), 50.0, 1e-9);
  EXPECT_NEAR(ramped_kp_nmprad(kLyingPosture_rad, 1.1), 100.0 * 1.1 / 1.2, 1e-9);
  EXPECT_EQ(ramped_kp_nmprad(kLyingPosture_rad, 1.5), 100.0);  // extends
  JointArray<double> nearly_standing_rad = test_robot().stand.nominal_rad;
  nearly_standing_rad[0] += 0.1;
  EXPECT_NEAR(ramped_kp_nmprad(nearly_standing_rad, 0.6), 50.0, 1e-9);
  EXPECT_EQ(ramped_kp_nmprad(nearly_standing_rad, 1.3), 100.0);
}

TEST(ControllerTest, StopSlowsDownWaitsForRestThenStands) {
  FakeLoop loop;
  loop.reach(Mode::kWalk);
  EXPECT_EQ(loop.output.policy_input.command.vx_mps, 1.0);
  loop.request(ModeRequest::kStand);
  // 1 m/s at 1 m/s^2, then 0.25 s at rest.
  double before_mps = 1.0;
  for (std::uint64_t n = 0; n < ticks_from_s(1.24); ++n) {
    ASSERT_EQ(loop.output.mode, Mode::kWalk);
    const double now_mps = loop.output.policy_input.command.vx_mps;
    ASSERT_NEAR(now_mps, std::max(before_mps - 0.25e-3, 0.0), 1e-9);
    before_mps = now_mps;
    loop.tick();
  }
  loop.run_s(0.02);
  EXPECT_EQ(loop.output.mode, Mode::kStand);
  loop.run_s(1.51);
  EXPECT_EQ(loop.output.command.joints().position_rad, loop.config.stand.nominal_rad);
}

TEST(ControllerTest, StopThatIsAskedForAgainAndAgainIsStillOneStop) {
  FakeLoop loop;
  loop.reach(Mode::kWalk);
  for (int n = 0; n < 14; ++n) {  // as a key that is held down
    loop.request(ModeRequest::kStand);
    loop.run_s(0.1);
  }
  EXPECT_EQ(loop.output.mode, Mode::kStand);
}

TEST(ControllerTest, StopEndsAfterItsLongestWaitIfTheRobotNeverRests) {
  FakeLoop loop;
  loop.reach(Mode::kWalk);
  loop.spoil = [&](ControllerInput& seen) {
    const double sign = seen.sensors.tick % 2 == 0 ? 1.0 : -1.0;
    seen.sensors.imu.angular_velocity_radps[2] = sign * 1.5;
    for (double& q : seen.sensors.joints.position_rad) q += sign * kTremble_rad;
  };
  loop.request(ModeRequest::kStand);
  loop.run_s(1.0 + 2.98);
  EXPECT_EQ(loop.output.mode, Mode::kWalk);
  loop.run_s(0.04);
  EXPECT_EQ(loop.output.mode, Mode::kStand);
}

TEST(ControllerTest, StopWaitsForTheSlewToReachZero) {
  ControllerConfig config = test_robot();
  config.walk.stop_deceleration_mps2 = 0.5;
  FakeLoop loop(Mode::kPassive, config);
  loop.reach(Mode::kWalk);
  loop.run_s(2.0);
  EXPECT_EQ(loop.output.policy_input.command.vx_mps, 1.0);
  loop.request(ModeRequest::kStand);
  loop.run_s(2.0 + 0.24);
  EXPECT_EQ(loop.output.mode, Mode::kWalk);
  loop.run_s(0.02);
  EXPECT_EQ(loop.output.mode, Mode::kStand);
}

TEST(ControllerTest, WalkRequestCancelsAStop) {
  FakeLoop loop;
  loop.reach(Mode::kWalk);
  const std::uint64_t episode = loop.output.policy_input.episode;
  loop.request(ModeRequest::kStand);
  loop.run_s(1.0);
  loop.request(ModeRequest::kWalk);
  EXPECT_EQ(loop.output.policy_input.command.vx_mps, 1.0);
  loop.run_s(3.0);
  EXPECT_EQ(loop.output.mode, Mode::kWalk);
  EXPECT_EQ(loop.output.policy_input.episode, episode);
}

TEST(ControllerTest, TorqueIsContinuousFromWalkToStand) {
  FakeLoop loop;
  loop.reach(Mode::kWalk);
  // Legs that yield by a fixed 0.1 rad under the robot's weight.
  loop.spoil = [&](ControllerInput& seen) {
    seen.sensors.joints.position_rad = loop.config.stand.nominal_rad;
    for (double& q : seen.sensors.joints.position_rad) q -= 0.1;
    seen.sensors.joints.velocity_radps = {};
    seen.sensors.joints.torque_nm = loop.controller.state().gate.joints.commanded_nm;
  };
  loop.request(ModeRequest::kStand);
  const auto torque_nm = [&] {
    const JointCommand& c = loop.output.command.joints();
    const double q = loop.output.policy_input.joints.position_rad[4];
    return joint_torque(q, 0.0, c.position_rad[4], c.velocity_radps[4], c.kp_nmprad[4],
                        c.kd_nmsprad[4], c.feedforward_nm[4]);
  };
  double before_nm = torque_nm();
  EXPECT_NEAR(before_nm, 50.0 * 0.1, 1e-6);
  while (loop.output.mode == Mode::kWalk) loop.tick();
  EXPECT_NEAR(torque_nm(), before_nm, 0.01);
  for (int n = 0; n < 6100; ++n) {
    before_nm = torque_nm();
    loop.tick();
    ASSERT_NEAR(torque_nm(), before_nm, 0.05);
  }
  EXPECT_NEAR(torque_nm(), 100.0 * 0.1, 1e-6);
}

TEST(ControllerTest, WalkThatIsAskedForDuringTheBlendBeginsWhereStandHoldsTheJoints) {
  FakeLoop loop;
  loop.action_rad[4] += 0.3;
  loop.reach(Mode::kWalk);
  loop.request(ModeRequest::kStand);
  while (loop.output.mode == Mode::kWalk) loop.tick();
  loop.run_s(0.3);
  const JointArray<double> held_rad = loop.output.command.joints().position_rad;
  ASSERT_GT(std::fabs(held_rad[4] - loop.config.stand.nominal_rad[4]), 0.1);
  loop.policy_hangs = true;  // no answer yet
  loop.request(ModeRequest::kWalk);
  EXPECT_EQ(loop.output.mode, Mode::kWalk);
  for (int j = 0; j < kNumJoints; ++j) {
    EXPECT_NEAR(loop.output.command.joints().position_rad[j], held_rad[j], 1e-3);
  }
}

TEST(ControllerTest, AHangingRobotDoesNotWalk) {
  ControllerConfig config = test_robot();
  config.gate.hanging = true;
  FakeLoop loop(Mode::kPassive, config);
  loop.reach(Mode::kStand);
  loop.request(ModeRequest::kWalk);
  EXPECT_EQ(loop.output.mode, Mode::kStand);
}

TEST(LieTest, AStandingRobotFoldsItsLegsBeforeItDamps) {
  FakeLoop loop;
  loop.reach(Mode::kStand);
  loop.request(ModeRequest::kLie);
  double fastest_radps = 0.0;
  std::uint64_t ticks = 1;
  for (; loop.output.mode == Mode::kStand && ticks < 40000; ++ticks) {
    const JointCommand& command = loop.output.command.joints();
    EXPECT_EQ(command.kp_nmprad[4], loop.config.stand.kp_nmprad);
    fastest_radps = std::max(fastest_radps, std::fabs(command.velocity_radps[4]));
    loop.tick();
  }
  EXPECT_EQ(loop.output.mode, Mode::kDamping);
  EXPECT_NEAR(static_cast<double>(ticks) * kControlPeriod_s, loop.config.stand.extend_s, 0.002);
  EXPECT_NEAR(fastest_radps, 1.875 * 0.6 / loop.config.stand.extend_s, 0.01);
  for (int j = 0; j < kNumJoints; ++j) {
    EXPECT_NEAR(loop.robot.now.joints.position_rad[j],
                loop.config.stand.fold_rad[j % kJointsPerLeg], 0.01);
  }
  // Nothing of it is left when the robot stands up again.
  loop.request(ModeRequest::kStand);
  loop.run_s(5.0);
  EXPECT_EQ(loop.output.mode, Mode::kStand);
}

TEST(LieTest, AWalkingRobotStopsFirst) {
  FakeLoop loop;
  loop.reach(Mode::kWalk);
  loop.request(ModeRequest::kLie);
  double vx_mps = 1.0;
  while (loop.output.mode == Mode::kWalk) {
    vx_mps = loop.output.policy_input.command.vx_mps;
    loop.tick();
  }
  EXPECT_EQ(vx_mps, 0.0);
  EXPECT_EQ(loop.output.mode, Mode::kStand);
  loop.run_s(1.49);
  EXPECT_EQ(loop.output.mode, Mode::kStand);
  loop.run_s(0.02);
  EXPECT_EQ(loop.output.mode, Mode::kDamping);
}

TEST(LieTest, ARisingRobotGoesDownAgainFromWhereItIs) {
  FakeLoop loop;
  loop.reach(Mode::kStandUp);
  loop.request(ModeRequest::kLie);
  EXPECT_EQ(loop.output.mode, Mode::kDamping);  // it lay on the ground
  loop.request(ModeRequest::kStand);
  loop.run_s(1.8);
  ASSERT_EQ(loop.output.mode, Mode::kStandUp);
  const double held_rad = loop.output.command.joints().position_rad[4];
  loop.request(ModeRequest::kLie);
  EXPECT_EQ(loop.output.mode, Mode::kStand);
  EXPECT_NEAR(loop.output.command.joints().position_rad[4], held_rad, 1e-3);
  loop.run_s(1.6);
  EXPECT_EQ(loop.output.mode, Mode::kDamping);
}

TEST(LieTest, ARobotThatLeansIsDampedAtOnce) {
  FakeLoop loop;
  loop.reach(Mode::kStand);
  loop.request(ModeRequest::kLie);
  loop.run_s(0.5);
  ASSERT_EQ(loop.output.mode, Mode::kStand);
  // Slowly, as an attitude that jumps is a fault.
  double angle_rad = 0.0;
  loop.spoil = [&](ControllerInput& seen) {
    constexpr double kRate_radps = 2.0;
    angle_rad += kRate_radps * kControlPeriod_s;
    seen.sensors.imu.orientation_wxyz = {std::cos(0.5 * angle_rad), std::sin(0.5 * angle_rad), 0.0,
                                         0.0};
    seen.sensors.imu.angular_velocity_radps[0] = kRate_radps;
    for (double& q : seen.sensors.joints.position_rad) {
      q += seen.sensors.tick % 2 == 0 ? kTremble_rad : -kTremble_rad;
    }
  };
  while (loop.output.mode == Mode::kStand && angle_rad < 1.0) loop.tick();
  EXPECT_EQ(loop.output.mode, Mode::kDamping) << fault_name(loop.output.first_fault);
  EXPECT_NEAR(angle_rad, 20.0 * 3.14159265 / 180.0, 0.01);
}

TEST(LieTest, WalkIsIgnoredUntilStandHasRaisedTheRobotAgain) {
  FakeLoop loop;
  loop.reach(Mode::kStand);
  loop.request(ModeRequest::kLie);
  loop.run_s(0.8);
  loop.request(ModeRequest::kWalk);
  EXPECT_EQ(loop.output.mode, Mode::kStand);
  const double held_rad = loop.output.command.joints().position_rad[4];
  loop.request(ModeRequest::kStand);
  EXPECT_NEAR(loop.output.command.joints().position_rad[4], held_rad, 1e-3);
  loop.run_s(1.4);
  loop.request(ModeRequest::kWalk);
  EXPECT_EQ(loop.output.mode, Mode::kStand);
  loop.run_s(0.2);
  EXPECT_NEAR(loop.output.command.joints().position_rad[4], loop.config.stand.nominal_rad[4], 1e-9);
  loop.request(ModeRequest::kWalk);
  EXPECT_EQ(loop.output.mode, Mode::kWalk);
}

TEST(LieTest, StopLetsARobotDownThatIsOnItsWayDownOrUpAgain) {
  for (const bool up_again : {false, true}) {
    FakeLoop loop;
    loop.reach(Mode::kStand);
    loop.request(ModeRequest::kLie);
    loop.run_s(0.8);
    if (up_again) loop.request(ModeRequest::kStand);
    loop.run_s(0.2);
    ASSERT_EQ(loop.output.mode, Mode::kStand);
    loop.request(ModeRequest::kStop);
    EXPECT_EQ(loop.output.mode, Mode::kDamping);
  }
}

TEST(LieTest, ARobotWhoseStiffnessStillRisesDoesNotGetAllOfItToLieDown) {
  ControllerConfig config = test_robot();
  config.stand.gain_ramp_s = 1.2;
  JointArray<double> posture_rad = config.stand.nominal_rad;
  posture_rad[0] += 0.1;  // so near that it does not fold first
  config.gate.lying_rad = posture_rad;
  FakeLoop loop(Mode::kPassive, config);
  loop.robot.now.joints.position_rad = posture_rad;
  loop.stand_up();
  loop.run_s(0.3);
  ASSERT_EQ(loop.output.mode, Mode::kStandUp);
  loop.request(ModeRequest::kLie);
  EXPECT_EQ(loop.output.mode, Mode::kDamping);
}

TEST(LieTest, DampDoesNotWait) {
  FakeLoop loop;
  loop.reach(Mode::kStand);
  loop.request(ModeRequest::kLie);
  loop.request(ModeRequest::kDamp);
  EXPECT_EQ(loop.output.mode, Mode::kDamping);
}

TEST(ControllerTest, AJointThatIsHeldAwayFromStandGivesWayBeforeItOverheats) {
  FakeLoop loop;
  loop.reach(Mode::kStand);
  ASSERT_EQ(loop.output.mode, Mode::kStand);
  const double continuous_nm = loop.config.gate.continuous_torque_nm[0];
  double torque_nm = 0.0, away_rad = 0.0;
  loop.spoil = [&](ControllerInput& seen) {  // its foot lies in sand
    const bool slips = away_rad < 0.35;
    away_rad = std::min(away_rad + 0.001, 0.35);
    const double held_rad = loop.config.stand.nominal_rad[3] - away_rad;
    const JointCommand& c = loop.output.command.joints();
    torque_nm = c.kp_nmprad[3] * (c.position_rad[3] - held_rad);
    seen.sensors.joints.position_rad[3] = held_rad;
    seen.sensors.joints.velocity_radps[3] = slips ? -0.001 * kControlHz : 0.0;
    seen.sensors.joints.torque_nm[3] = torque_nm;
    for (const int j : {4, 5}) {  // as those of a real leg
      seen.sensors.joints.position_rad[j] += seen.sensors.tick % 2 == 0 ? 1e-6 : -1e-6;
    }
  };
  loop.run_s(9.0);
  EXPECT_NEAR(torque_nm, 35.0, 1e-9);  // the whole stiffness, until the joint is warm
  loop.run_s(110.0);
  EXPECT_EQ(loop.output.faults, 0u);
  EXPECT_NEAR(torque_nm, 0.7 * continuous_nm, 0.01);
  EXPECT_EQ(loop.output.command.joints().position_rad[4], loop.config.stand.nominal_rad[4]);
}

TEST(ControllerTest, AJointThatBearsTooMuchForEverMakesTheRobotLieDownAndIsThenAnOverload) {
  FakeLoop loop;
  loop.reach(Mode::kStand);
  const double continuous_nm = loop.config.gate.continuous_torque_nm[0];
  double farthest_rad = 0.0;
  loop.spoil = [&](ControllerInput& seen) {  // a load, which giving way does not relieve
    // With breaks, as a torque that was not commanded is a fault as well.
    if (seen.sensors.tick % 160 < 150) seen.sensors.joints.torque_nm[5] = 1.2 * continuous_nm;
    if (loop.output.mode != Mode::kStand || loop.output.warnings != 0) return;
    farthest_rad = std::max(farthest_rad, std::fabs(loop.output.command.joints().position_rad[5] -
                                                    loop.config.stand.nominal_rad[5]));
  };
  while (loop.output.warnings == 0 && loop.output.faults == 0) loop.tick();
  EXPECT_EQ(loop.output.warnings, warning_bit(Warning::kHeating));
  while (loop.output.mode == Mode::kStand) loop.tick();
  EXPECT_EQ(loop.output.mode, Mode::kDamping);
  loop.run_s(200.0);
  EXPECT_EQ(loop.output.first_fault, Fault::kOverload);
  EXPECT_LE(farthest_rad, loop.config.stand.reached_rad + 1e-9);
}

std::uint64_t hash_of(const ControllerOutput& output, const ControllerState& state) {
  StateHash hash;
  hash.add(output);
  hash.add(state);
  return hash.value();
}

TEST(ControllerTest, SnapshotContinuesWithTheSameBits) {
  ControllerConfig config = test_robot();
  config.shaping.envelope.acceleration_mps2 = 1.0;
  FakeLoop loop(Mode::kPassive, config);
  std::vector<ControllerInput> inputs;
  std::vector<std::uint64_t> hashes;
  std::vector<ControllerState> snapshots;
  // A life: stand up, walk, stop, walk into a fault, be reset.
  loop.spoil = [&](ControllerInput& seen) {
    const std::uint64_t tick = seen.sensors.tick;
    const auto at = [&](std::uint64_t when, ModeRequest wish, std::uint64_t id) {
      if (tick < when) return;
      seen.command.request = wish;
      seen.command.request_id = id;
    };
    at(5, ModeRequest::kArm, 1);
    at(10, ModeRequest::kStand, 2);
    at(11000, ModeRequest::kWalk, 3);
    at(14000, ModeRequest::kStand, 4);
    at(26000, ModeRequest::kWalk, 5);
    at(37500, ModeRequest::kResetFault, 6);
    if (tick > 28000 && tick < 28100) seen.sensors.joints.torque_nm[1] = 80.0;
    snapshots.push_back(loop.controller.state());
    inputs.push_back(seen);
  };
  std::array<bool, 6> visited{};
  for (int n = 0; n < 38000; ++n) {
    loop.action_rad[2] = -1.1 + 0.001 * (n % 100);
    loop.tick();
    hashes.push_back(hash_of(loop.output, loop.controller.state()));
    visited[static_cast<std::size_t>(loop.output.mode)] = true;
  }
  EXPECT_EQ(visited, (std::array<bool, 6>{true, true, true, true, true, true}));
  EXPECT_EQ(loop.output.mode, Mode::kPassive);

  for (const std::size_t start : {0u, 5u, 3000u, 10500u, 11001u, 13333u, 15000u, 28019u, 30000u}) {
    Controller other(config, Mode::kPassive);
    other.restore(snapshots[start]);
    ControllerOutput output;
    const std::size_t end = std::min<std::size_t>(start + 12000, inputs.size());
    for (std::size_t n = start; n < end; ++n) {
      other.step(inputs[n], output);
      ASSERT_EQ(hash_of(output, other.state()), hashes[n]) << start << " " << n;
    }
  }
}

}  // namespace
}  // namespace sandrunner
