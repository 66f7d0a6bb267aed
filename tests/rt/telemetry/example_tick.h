// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "rt/core/robot_description.h"
#include "rt/core/safety_gate.h"
#include "rt/loop/tick_record.h"
#include "tests/support/all_joints.h"

namespace sandrunner {

/// A robot with names of its own.
inline RobotDescription example_robot() {
  return {
      .name = "example",
      .leg_names = {"FL", "FR", "RL", "RR"},
      .joint_names = {"FL_hip", "FL_thigh", "FL_calf", "FR_hip", "FR_thigh", "FR_calf", "RL_hip",
                      "RL_thigh", "RL_calf", "RR_hip", "RR_thigh", "RR_calf"},
      .urdf = "<robot/>",
      .base_frame = "base_link",
      .ros_urdf = "<robot\nname=\"example\"/>",
      .frames = {{.name = "trunk", .parent = "base_link"},
                 {.name = "FL_hip_link",
                  .parent = "trunk",
                  .translation_m = {0.3, 0.1, 0.0},
                  .joint = 0,
                  .axis = {1.0, 0.0, 0.0}},
                 {.name = "FL_thigh_link",
                  .parent = "FL_hip_link",
                  .translation_m = {0.0, 0.05, -0.01},
                  .joint = 1,
                  .axis = {0.0, 1.0, 0.0}},
                 {.name = "FL_foot", .parent = "FL_thigh_link", .translation_m = {0.0, 0.0, -0.4}}},
      .outline = {{.frame = "FL_foot", .radius_m = 0.02}}};
}

inline constexpr std::int64_t kExampleStart_ns = 1'700'000'000'900'000'000;

/// A tick of a robot that walks along its x axis at 0.8 m/s, turned 90 degrees to the left; all
/// values differ. The joint positions grow by 1e-6 rad per tick.
inline TickRecord example_tick(std::uint64_t tick) {
  TickRecord r{};
  SensorFrame& s = r.input.sensors;
  s.tick = s.imu.tick = tick;
  s.joints.tick.fill(tick);
  JointCommand wanted;
  for (int j = 0; j < kNumJoints; ++j) {
    s.joints.position_rad[j] = 0.1 * j + 1e-6 * static_cast<double>(tick);
    s.joints.velocity_radps[j] = 1.0 + j;
    s.joints.torque_nm[j] = -2.0 - j;
    wanted.position_rad[j] = -0.5 - 0.01 * j;
    wanted.kp_nmprad[j] = 50.0 + j;
    wanted.kd_nmsprad[j] = 0.5 + j;
  }
  s.imu.orientation_wxyz = {0.70710678118654752, 0.0, 0.0, 0.70710678118654752};
  s.imu.angular_velocity_radps = {0.1, 0.2, 0.3};
  s.imu.linear_acceleration_mps2 = {0.4, 0.5, 9.8};
  r.input.policy.sequence = 5;
  r.input.policy.episode = 1;
  r.input.policy.estimate = {.body_height_m = 0.45,
                             .velocity_mps = {0.8, 0.0, 0.01},
                             .foot_height_m = {0.01, 0.02, 0.03, 0.04}};
  GateState gate;
  r.output.command =
      SafetyGate(
          {.torque_limit_nm = all_joints(1e9), .kp_limit_nmprad = 1e3, .kd_limit_nmsprad = 50.0},
          {2.0, 2.0, 2.0})
          .pass(wanted, true, {}, gate);
  r.output.mode = Mode::kWalk;
  r.output.policy_input.episode = 1;
  r.output.policy_input.command = {.vx_mps = 0.9, .vy_mps = -0.1, .wz_radps = 0.2};
  r.timing = {.late_ns = 2000, .read_ns = 3000, .control_ns = 4000, .write_ns = 5000};
  return r;
}

}  // namespace sandrunner
