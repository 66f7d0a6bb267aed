// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "rt/core/fma.h"

namespace sandrunner {

/// `value` held to [lower, upper]. `Scalar` is double, float or a pack with `min` and `max` found
/// by argument-dependent lookup. A scalar NaN stays NaN.
template <typename Scalar>
Scalar clamp_to(const Scalar& value, const Scalar& lower, const Scalar& upper) {
  using std::max;
  using std::min;
  return min(max(value, lower), upper);
}

/// The law of a joint drive: kp (q_des - q) + kd (qd_des - qd) + tau_ff, in N m.
///
/// The one definition: the simulator's actuators (also as a pack of robots), emulated drives and
/// torque drives all evaluate it. Its two fused operations are written out, so that every caller
/// gets the same bits. Positions in rad, velocities in rad/s, kp in N m/rad, kd in N m s/rad; the
/// torque is not limited here.
template <typename Scalar>
Scalar joint_torque(const Scalar& position_rad, const Scalar& velocity_radps,
                    const Scalar& position_desired_rad, const Scalar& velocity_desired_radps,
                    const Scalar& kp_nmprad, const Scalar& kd_nmsprad,
                    const Scalar& feedforward_nm) {
  return fma(kp_nmprad, position_desired_rad - position_rad,
             fma(kd_nmsprad, velocity_desired_radps - velocity_radps, feedforward_nm));
}

}  // namespace sandrunner
