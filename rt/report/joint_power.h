// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rt/loop/tick_record.h"

namespace sandrunner {

/// What all joints did in a tick: sum of tau qd, W, and of tau^2, N^2 m^2.
struct JointPower {
  double mechanical_w = 0.0, torque_squared_nm2 = 0.0;
};

/// Of the true torque after the clamp and the speed before the step that it was worked out from;
/// of a robot that offers no truth, of what its drives report.
inline JointPower joint_power(const TickRecord& tick) noexcept {
  const JointState& sensed = tick.input.sensors.joints;
  const bool truth = tick.has_truth != 0;
  const JointArray<double>& torque_nm = truth ? tick.truth.joint_torque_nm : sensed.torque_nm;
  const JointArray<double>& velocity_radps =
      truth ? tick.before.joint_velocity_radps : sensed.velocity_radps;
  JointPower sum;
  for (int j = 0; j < kNumJoints; ++j) {
    sum.mechanical_w += torque_nm[j] * velocity_radps[j];
    sum.torque_squared_nm2 += torque_nm[j] * torque_nm[j];
  }
  return sum;
}

}  // namespace sandrunner
