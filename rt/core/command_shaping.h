// SPDX-License-Identifier: BSD-3-Clause
// Shaping of the velocity command, shared by controller, simulator and training. `Scalar` is
// double, float or a pack of such with fma, sqrt, min and max found by argument-dependent lookup.
#pragma once

#include <cmath>

#include "rt/core/joint_pd.h"
#include "rt/core/messages.h"

namespace sandrunner {

/// Centripetal acceleration that the paper's authors allow a commanded turn: 0.3 g.
inline constexpr double kCentripetalLimit_mps2 = 0.3 * kGravity_mps2;

/// Yaw rate held to `centripetal_limit_mps2` / |v_xy|; without a speed it passes unchanged.
/// Source: the authors' published controller.
template <typename Scalar>
Scalar shape_yaw_rate(const Scalar& wz_radps, const Scalar& vx_mps, const Scalar& vy_mps,
                      const Scalar& centripetal_limit_mps2) {
  using std::fma;
  using std::max;
  using std::sqrt;
  const Scalar speed_mps = sqrt(fma(vx_mps, vx_mps, vy_mps * vy_mps));
  // The floor only keeps the quotient finite at rest; the bound is then 1e9 times any yaw rate.
  const Scalar bound_radps = centripetal_limit_mps2 / max(speed_mps, static_cast<Scalar>(1e-9));
  return clamp_to<Scalar>(wz_radps, static_cast<Scalar>(0.0) - bound_radps, bound_radps);
}

/// Next value on the way from `current` to `wanted`, at most `max_step` away from `current`.
/// Arrives at exactly `wanted`; an infinite `max_step` passes `wanted` through.
template <typename Scalar>
Scalar slew(const Scalar& current, const Scalar& wanted, const Scalar& max_step) {
  return clamp_to<Scalar>(wanted, current - max_step, current + max_step);
}

}  // namespace sandrunner
