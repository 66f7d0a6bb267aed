// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rt/core/joint_pd.h"
#include "sim/lanes/lanes.h"

namespace sandrunner::sim {

/// Electrical limit of a drive, seen at the joint: |tau| <= stall torque (1 - |qd| / no-load speed)
/// while it drives in the direction of motion. Defaults from the published figures of the robot's
/// motor (0.253 N m/A, 0.32 ohm line to line, 48 V) and gear (6.75): 48/0.253/6.75 = 28.1 rad/s,
/// 48/0.32*0.253*6.75 = 256 N m. The line leaves the full 63.45 N m up to 21.1 rad/s.
struct TorqueSpeedLine {
  double stall_torque_nm = 256.0;
  double no_load_speed_radps = 28.1;
};

/// Torque of a joint drive, N m: the PD law, clamped to +-`limit_nm` (and to the line, if there is
/// one: stall > 0). Positions rad, rates rad/s, kp N m/rad, kd N m s/rad, `inverse_no_load_speed`
/// s/rad.
template <typename S>
inline S drive_torque(S q, S qd, S q_desired, S qd_desired, S kp, S kd, S feedforward_nm,
                      S limit_nm, S stall_torque_nm, S inverse_no_load_speed) noexcept {
  const S wanted = joint_torque<S>(q, qd, q_desired, qd_desired, kp, kd, feedforward_nm);
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
