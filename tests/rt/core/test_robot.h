// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rt/core/controller.h"
#include "tests/support/all_joints.h"

namespace sandrunner {

inline constexpr JointArray<double> kLyingPosture_rad = {0.3, 1.5, -2.3, -0.3, 1.5, -2.3,
                                                         0.3, 1.5, -2.3, -0.3, 1.5, -2.3};

/// What the controller knows of a robot of round numbers; everything else at its default.
inline ControllerConfig test_robot() {
  ControllerConfig c;
  c.walk.kp_nmprad = 50.0;
  c.walk.kd_nmsprad = 0.5;
  c.stand.kp_nmprad = 100.0;
  c.stand.kd_nmsprad = 1.0;
  c.stand.fold_rad = {0.0, 1.2, -2.4};
  c.damping.kd_nmsprad.fill(2.0);
  for (int j = 0; j < kNumJoints; j += kJointsPerLeg) {
    const auto set = [&](int joint, double nominal_rad, double lower_rad, double upper_rad) {
      c.stand.nominal_rad[joint] = nominal_rad;
      c.gate.joint_lower_rad[joint] = lower_rad;
      c.gate.joint_upper_rad[joint] = upper_rad;
    };
    set(j, 0.0, -1.5, 1.5);
    set(j + 1, 0.6, -3.0, 3.0);
    set(j + 2, -1.2, -2.5, 0.0);
  }
  c.gate.speed_limit_radps = all_joints(25.0);
  c.gate.speed_fault_radps = {60.0, 60.0, 60.0};
  c.gate.kp_limit_nmprad = 200.0;
  c.gate.kd_limit_nmsprad = 5.0;
  c.gate.power_limit_w = 8000.0;
  c.gate.continuous_torque_nm = {30.0, 30.0, 30.0};
  c.gate.thermal_time_s = 20.0;
  c.shaping.envelope = {.forward_mps = 2.0,
                        .backward_mps = 1.0,
                        .lateral_mps = 0.5,
                        .yaw_radps = 1.0,
                        .acceleration_mps2 = 1e4,
                        .yaw_acceleration_radps2 = 1e4};
  c.gate.torque_limit_nm = all_joints(60.0);
  c.gate.lying_rad = kLyingPosture_rad;
  return c;
}

}  // namespace sandrunner
