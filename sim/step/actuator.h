// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rt/core/joint_pd.h"
#include "sim/lanes/lanes.h"
#include "sim/robot/robot_model.h"

namespace sandrunner::sim {

/// A TorqueSpeedLine (sim/robot/robot_model.h) as drive_torque takes it, of HAA, HFE and KFE. A
/// stall torque of 0: no line.
template <typename S>
struct DriveLine {
  LegJoints<S> stall_torque_nm{};
  LegJoints<S> inverse_no_load_speed{};  ///< s/rad
};
template <typename S>
DriveLine<S> drive_line(const TorqueSpeedLine& line) noexcept {
  DriveLine<S> drive;
  for (int j = 0; j < kJointsPerLeg; ++j) {
    drive.stall_torque_nm[j] = S(line.stall_torque_nm[j]);
    drive.inverse_no_load_speed[j] = S(1.0 / line.no_load_speed_radps[j]);
  }
  return drive;
}

/// What a joint drive is commanded: rad, rad/s, N m/rad, N m s/rad, N m.
template <typename S>
struct DriveTarget {
  S q{}, qd{}, kp{}, kd{}, feedforward_nm{};
};

/// Torque of the drive of joint j at `q` rad and `qd` rad/s, N m: the PD law, clamped to
/// +-`limit_nm` and, with a stall torque above 0, to the drive's line.
template <typename S>
inline S drive_torque(int j, S q, S qd, const DriveTarget<S>& target, S limit_nm,
                      const DriveLine<S>& of_leg) noexcept {
  const S wanted =
      joint_torque<S>(q, qd, target.q, target.qd, target.kp, target.kd, target.feedforward_nm);
  const S stall_torque_nm = of_leg.stall_torque_nm[j % kJointsPerLeg];
  const S inverse_no_load_speed = of_leg.inverse_no_load_speed[j % kJointsPerLeg];
  S upper = limit_nm, lower = -limit_nm;
  const Mask<S> line = stall_torque_nm > S(0.0);
  if (any(line)) {
    // Braking torque is not limited by the line: only the side in the direction of motion is.
    const S forward = max(stall_torque_nm * fma(-qd, inverse_no_load_speed, S(1.0)), S(0.0));
    const S backward = max(stall_torque_nm * fma(qd, inverse_no_load_speed, S(1.0)), S(0.0));
    upper = select(line, min(upper, forward), upper);
    lower = select(line, max(lower, -backward), lower);
  }
  return min(max(wanted, lower), upper);
}

}  // namespace sandrunner::sim
