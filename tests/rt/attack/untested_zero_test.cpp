// SPDX-License-Identifier: BSD-3-Clause
// Errors of mounting and configuration that are zero in the lying pose, or small enough there for
// arming: what the robot does with them. `sandrunner check` has to find them, not the gate.
#include <gtest/gtest.h>

#include <cstdio>
#include <functional>
#include <string>

#include "outcome.h"

namespace sandrunner::attack {
namespace {

using Breaks = std::function<void(FaultyRobot&)>;

/// The joints `joint`, `joint` + 3, ... report `scale` times their position: a gear that is wrong.
/// They then give `scale` times the torque that they are commanded, and report the commanded one.
Breaks wrong_gear(int joint, double scale) {
  return [=](FaultyRobot& robot) {
    for (int j = joint; j < kNumJoints; j += kJointsPerLeg) {
      robot.drive_is_misled |= std::uint64_t{1} << j;
      robot.torque_scale[j] = scale;
    }
    robot.spoil = [=](SensorFrame& fresh, auto&&...) {
      for (int j = joint; j < kNumJoints; j += kJointsPerLeg) {
        fresh.joints.position_rad[j] *= scale;
        fresh.joints.velocity_radps[j] *= scale;
        fresh.joints.torque_nm[j] /= scale;
      }
    };
  };
}
Breaks zero_off(int joint, double offset_rad) {
  return [=](FaultyRobot& robot) {
    for (int j = joint; j < kNumJoints; j += kJointsPerLeg) {
      robot.drive_is_misled |= std::uint64_t{1} << j;
    }
    robot.spoil = [=](SensorFrame& fresh, auto&&...) {
      for (int j = joint; j < kNumJoints; j += kJointsPerLeg) {
        fresh.joints.position_rad[j] += offset_rad;
      }
    };
  };
}
Breaks imu_turned(double yaw_deg) {
  return [=](FaultyRobot& robot) {
    robot.spoil = [yaw_rad = yaw_deg * std::numbers::pi / 180.0](SensorFrame& fresh, auto&&...) {
      const Vector3 up{0.0, 0.0, 1.0};
      const Rotation back = turned({1.0, 0.0, 0.0, 0.0}, up, -yaw_rad);
      ImuSample& imu = fresh.imu;
      imu.orientation_wxyz = turned(imu.orientation_wxyz, up, yaw_rad);
      imu.angular_velocity_radps = rotated(back, imu.angular_velocity_radps);
      imu.linear_acceleration_mps2 = rotated(back, imu.linear_acceleration_mps2);
    };
  };
}

/// Arms, stands for 4 s, walks at 1 m/s for 8 s.
void print_run(const std::string& name, const World& world, const Breaks& breaks) {
  AttackLoop loop(world, Drives::kGains);
  if (breaks) breaks(loop.robot);
  loop.run(0.1);
  loop.ask(ModeRequest::kArm);
  loop.run(0.1);
  const bool armed = loop.mode() == Mode::kDamping;
  std::string text = armed ? ", armed" : ", NOT armed";
  if (armed) {
    loop.ask(ModeRequest::kStand);
    loop.run(4.0);
    text += loop.mode() == Mode::kStand ? ", stands" : ", does NOT stand";
  }
  if (loop.mode() == Mode::kStand) {
    loop.command.velocity.vx_mps = 1.0;
    loop.ask(ModeRequest::kWalk);
    text += ", walk:";
  }
  print_outcome(name + text, watch(loop, 8.0));
}

TEST(UntestedZeroTest, CampaignOverErrors) {
  print_outcomes_header();
  for (const std::string robot : {"raibo", "go2"}) {
    for (const std::string terrain : {"rigid", "dry-sand"}) {
      if (!is_selected(robot + ", " + terrain)) continue;
      const World world(robot, terrain);
      const std::string where = robot + ", " + terrain + ", ";
      print_run(where + "control", world, nullptr);
      const char* const joints[] = {"HAA", "HFE", "KFE"};
      for (int joint = 0; joint < kJointsPerLeg; ++joint) {
        for (const double scale : {2.0, 0.5}) {
          print_run(where + joints[joint] + " gear x " + (scale > 1.0 ? "2" : "0.5"), world,
                    wrong_gear(joint, scale));
        }
      }
      print_run(where + "IMU yaw 90", world, imu_turned(90.0));
      print_run(where + "IMU yaw 180", world, imu_turned(180.0));
      print_run(where + "KFE -0.29 rad", world, zero_off(2, -0.29));
      print_run(where + "KFE +0.29 rad", world, zero_off(2, 0.29));
      print_run(where + "HAA +0.29 rad", world, zero_off(0, 0.29));
    }
  }
}

}  // namespace
}  // namespace sandrunner::attack
