// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "estimator/cost_of_transport.h"
#include "rt/loop/tick_record.h"

namespace sandrunner {

/// What all joints did in a tick: sum of tau qd, W, and of tau^2, N^2 m^2, with tau times its heat
/// factor (estimator/cost_of_transport.h).
struct JointPower {
  double mechanical_w = 0.0, torque_squared_nm2 = 0.0;
};

/// The true torque after the clamp; without truth, what the drives report.
inline const JointArray<double>& torque_of(const TickRecord& tick) noexcept {
  return tick.has_truth != 0 ? tick.truth.joint_torque_nm : tick.input.sensors.joints.torque_nm;
}

/// Of `torque_of` and the true speed before the step that the torque was worked out from; without
/// truth, of what the drives report.
inline JointPower joint_power(const TickRecord& tick,
                              const LegJoints<double>& heat_factor) noexcept {
  const JointArray<double>& torque_nm = torque_of(tick);
  const JointArray<double>& velocity_radps = tick.has_truth != 0
                                                 ? tick.before.joint_velocity_radps
                                                 : tick.input.sensors.joints.velocity_radps;
  JointPower sum;
  for (int j = 0; j < kNumJoints; ++j) {
    sum.mechanical_w += torque_nm[j] * velocity_radps[j];
    const double as_haa_nm = heat_factor[j % kJointsPerLeg] * torque_nm[j];
    sum.torque_squared_nm2 += as_haa_nm * as_haa_nm;
  }
  return sum;
}

}  // namespace sandrunner
