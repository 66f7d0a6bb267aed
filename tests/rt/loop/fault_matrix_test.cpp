// SPDX-License-Identifier: BSD-3-Clause
// Every fault in every mode in which it is judged, with drives that evaluate the gains and with
// drives that take a torque: how long until the robot only brakes, and how hard it moves after.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "disturbed_loop.h"
#include "rt/core/rotation.h"
#include "tests/support/not_finite.h"

namespace sandrunner {
namespace {

using FaultMatrixTest = EveryModeTest;

struct FaultCase {
  Fault fault;
  std::uint64_t within_ticks;  ///< from the first disturbed tick to the one that brakes
  std::function<void(DisturbedLoop&)> begin;
  double reached_rad = 0.25;  ///< controller.stand.reached_rad
};

std::vector<FaultCase> every_case() {
  const auto sensor = [](Fault fault, std::uint64_t within_ticks, auto spoil) {
    return FaultCase{fault, within_ticks, [spoil](DisturbedLoop& p) { p.robot.spoil = spoil; }};
  };
  using F = SensorFrame&;
  using G = const SensorFrame&;
  using N = std::uint64_t;
  const double half_rad = 0.5 * 61.0 * 3.14159265358979 / 180.0;
  const std::array<double, 4> on_its_side = {std::cos(half_rad), std::sin(half_rad), 0.0, 0.0};
  return {
      sensor(Fault::kNonFiniteJoint, 1, [](F f, G, N) { f.joints.position_rad[4] = kNan; }),
      sensor(Fault::kNonFiniteImu, 1, [](F f, G, N) { f.imu.orientation_wxyz[1] = kNan; }),
      {Fault::kNonFiniteAction, 42,
       [](DisturbedLoop& p) {
         p.policy.spoil = [](PolicyOutput& o, auto&) { o.target_rad[3] = kNan; };
       }},
      {Fault::kNonFiniteCommand, 1, [](DisturbedLoop& p) { p.command.velocity.vy_mps = kNan; }},
      sensor(Fault::kJointsStale, 9, [](F f, G g, N) { f.joints = g.joints; }),
      sensor(Fault::kImuStale, 121, [](F f, G g, N) { f.imu = g.imu; }),
      {Fault::kPolicyStale, 122, [](DisturbedLoop& p) { p.policy.hangs = true; }},
      // It jumps there, which is a fault as well, but not the first.
      sensor(Fault::kJointPosition, 1, [](F f, G, N) { f.joints.position_rad[2] = 0.4; }),
      sensor(Fault::kJointSpeed, 1, [](F f, G, N) { f.joints.velocity_radps[1] = -60.1; }),
      sensor(Fault::kJointTorque, 20, [](F f, G, N) { f.joints.torque_nm[7] = 76.2; }),
      sensor(Fault::kTilt, 1, [on_its_side](F f, G, N) { f.imu.orientation_wxyz = on_its_side; }),
      sensor(Fault::kDriveFault, 1, [](F f, G, N) { f.joints.drive_fault[11] = 7; }),
      sensor(Fault::kEmergencyStop, 1, [](F f, G, N) { f.emergency_stop = 1; }),
      {Fault::kDrivesCut, 1, [](DisturbedLoop& p) { p.robot.cut_drives(); }},
      {Fault::kTime, 1, [](DisturbedLoop& p) { --p.tick; }},
      {Fault::kLoopStalled, 1, [](DisturbedLoop& p) { p.tick += 121; }},
      sensor(Fault::kEncoderJump, 1, [](F f, G, N) { f.joints.position_rad[0] += 0.3; }),
      sensor(Fault::kEncoderFrozen, 4000,
             [](F f, G g, N) {
               const JointArray<std::uint64_t> fresh = f.joints.tick;
               f.joints = g.joints;
               f.joints.tick = fresh;
               // That of a joint at rest does no harm and is none: one that says that it moves.
               double& velocity_radps = f.joints.velocity_radps[4];
               if (std::fabs(velocity_radps) < 0.1) velocity_radps = 3.0;
             }),
      {Fault::kPolicyFrozen, 900,
       [](DisturbedLoop& p) {
         p.policy.spoil = [](PolicyOutput& o, const auto& before) { o.target_rad = before; };
       }},
      // With breaks, as a torque that was not commanded is a fault as well.
      sensor(Fault::kOverload, 40000,
             [](F f, G, N n) {
               if (n % 160 < 150) f.joints.torque_nm[7] = 60.0;
             }),
      sensor(Fault::kFreeFall, 1000,
             [](F f, G, N n) {
               f.imu.linear_acceleration_mps2 = {0.5, 0.5, n % 2 == 0 ? 0.5 : -0.5};
             }),
      // Knees give by 0.08 rad under the robot's weight.
      {.fault = Fault::kNotStanding,
       .within_ticks = 12000,
       .begin = [](DisturbedLoop&) {},
       .reached_rad = 0.02},
      sensor(Fault::kImuFrozen, 10,
             [](F f, G g, N) {
               const std::uint64_t fresh = f.imu.tick;
               f.imu = g.imu;
               f.imu.tick = fresh;
             }),
      sensor(Fault::kImuRange, 1, [](F f, G, N) { f.imu.angular_velocity_radps[1] = 41.0; }),
      sensor(Fault::kImuAttitude, 6000,
             [](F f, G, N) {
               Vector3& felt = f.imu.linear_acceleration_mps2;
               felt = rotated(turned({1.0, 0.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, 0.8), felt);
             }),
      sensor(Fault::kImuGyro, 600, [](F f, G, N) { f.imu.angular_velocity_radps[2] += 3.0; }),
      sensor(Fault::kTorqueMissing, 161, [](F f, G, N) { f.joints.torque_nm[4] += 15.0; }),
      {Fault::kNotFollowing, 4400,
       [](DisturbedLoop& p) {
         if (p.record.output.mode == Mode::kStand) p.ask(ModeRequest::kLie);
         JointArray<double> at_rad = p.simulator.state().robot.rigid.q;
         if (p.record.output.mode == Mode::kStandUp) at_rad[2] = -2.2;
         p.hand = hold(1u << 2, at_rad, at_rad);
       }},
      sensor(Fault::kSpeedMismatch, 900, [](F f, G, N) { f.joints.velocity_radps[1] += 2.0; }),
      sensor(Fault::kForeignTraffic, 1, [](F f, G, N) { f.foreign_traffic = 1u << 4; }),
  };
}

TEST_F(FaultMatrixTest, EveryFaultInEveryModeOnlyBrakesInTimeAndStaysHarmless) {
  double worst_torque_nm = 0.0, worst_speed_radps = 0.0;
  int runs = 0;
  for (const FaultCase& c : every_case()) {
    const FaultRow& row = kFaultTable[std::countr_zero(static_cast<std::uint64_t>(c.fault))];
    std::uint64_t slowest_ticks = 0;
    double torque_nm = 0.0, speed_radps = 0.0;
    for (const Mode mode : kModes) {
      if ((row.modes & mode_set(mode)) == 0) continue;
      for (const Drives drives : {Drives::kGains, Drives::kTorque}) {
        SCOPED_TRACE(std::string(row.name) + " in " + mode_name(mode) +
                     (drives == Drives::kGains ? ", gains" : ", torque"));
        ProcessConfig used = config;
        used.controller.stand.reached_rad = c.reached_rad;
        DisturbedLoop run(used, policy, drives, snapshots.at(mode));
        const TickRecord& record = run.record;
        run.step();  // the last good one
        c.begin(run);
        const auto bit = static_cast<std::uint64_t>(c.fault);
        std::uint64_t ticks = 0;
        do {
          run.step();
          ++ticks;
        } while ((record.output.faults & bit) == 0 && ticks < c.within_ticks);
        ASSERT_NE(record.output.faults & bit, 0u) << "not noticed in " << ticks << " ticks";
        ASSERT_EQ(record.output.mode, Mode::kFault);
        if (mode != Mode::kFault) {
          EXPECT_EQ(record.output.first_fault, c.fault);
        }
        slowest_ticks = std::max(slowest_ticks, ticks);
        for (int n = 0; n < 1000; ++n) {  // a quarter of a second
          for (int j = 0; j < kNumJoints; ++j) {
            ASSERT_EQ(run.robot.last.joints().kp_nmprad[j], 0.0);
            ASSERT_EQ(run.robot.last.joints().feedforward_nm[j], 0.0);
            ASSERT_EQ(run.robot.last.joints().velocity_radps[j], 0.0);
          }
          const RobotTruth& truth = record.truth;
          for (int j = 0; j < kNumJoints; ++j) {
            const double joint_nm = std::fabs(truth.joint_torque_nm[j]);
            ASSERT_LE(joint_nm, config.robot.model.torque_limit_nm[j]) << "joint " << j;
            torque_nm = std::max(torque_nm, joint_nm);
            speed_radps = std::max(speed_radps, std::fabs(truth.joint_velocity_radps[j]));
          }
          run.step();
        }
        ++runs;
      }
    }
    std::printf("%-18s %6.2f ms to damping, then at most %5.1f N m, %5.1f rad/s\n", row.name,
                0.25 * static_cast<double>(slowest_ticks), torque_nm, speed_radps);
    worst_torque_nm = std::max(worst_torque_nm, torque_nm);
    worst_speed_radps = std::max(worst_speed_radps, speed_radps);
  }
  std::printf("%d runs: at most %.1f N m, %.1f rad/s\n", runs, worst_torque_nm, worst_speed_radps);
  EXPECT_LT(worst_speed_radps, 30.0);
}

TEST_F(FaultMatrixTest, EveryFaultOfTheTableHasACase) {
  // faults_test.cpp, broken_robot_test.cpp
  std::uint64_t covered = fault_bit(Fault::kNonFiniteOutput) | fault_bit(Fault::kJointMisplaced);
  for (const FaultCase& c : every_case()) covered |= static_cast<std::uint64_t>(c.fault);
  EXPECT_EQ(covered, (std::uint64_t{1} << kNumFaults) - 1);
}

}  // namespace
}  // namespace sandrunner
