// SPDX-License-Identifier: BSD-3-Clause
// Shaping of the velocity command, shared by controller, simulator and training. `Scalar` is
// double, float or a pack of such with fma, sqrt, min and max found by argument-dependent lookup.
#pragma once

#include <algorithm>
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
  using std::max;
  using std::sqrt;
  const Scalar speed_mps = sqrt(fma(vx_mps, vx_mps, vy_mps * vy_mps));
  // The floor only keeps the quotient finite at rest; the bound is then 1e9 times any yaw rate.
  const Scalar bound_radps = centripetal_limit_mps2 / max(speed_mps, static_cast<Scalar>(1e-9));
  return clamp_to<Scalar>(wz_radps, static_cast<Scalar>(0.0) - bound_radps, bound_radps);
}

/// The velocity commands that a policy was trained for: what it does beyond them nobody knows.
/// Nothing moves inside the default one.
struct CommandEnvelope {
  // Largest speeds, m/s and rad/s.
  double forward_mps = 0.0, backward_mps = 0.0, lateral_mps = 0.0, yaw_radps = 0.0;
  // Largest changes of the command: of vx and of vy, of the yaw rate.
  double acceleration_mps2 = 0.0, yaw_acceleration_radps2 = 0.0;
};

/// For a policy that does not say what it was trained for.
inline constexpr CommandEnvelope kNarrowEnvelope{.forward_mps = 0.5,
                                                 .backward_mps = 0.25,
                                                 .lateral_mps = 0.2,
                                                 .yaw_radps = 0.4,
                                                 .acceleration_mps2 = 0.5,
                                                 .yaw_acceleration_radps2 = 0.5};

/// A command brought inside an envelope.
struct EnvelopedCommand {
  VelocityCommand command;
  /// How much of what was asked is left, of the velocity or of the yaw rate, whichever is less: 1
  /// is all of it.
  double share = 1.0;
};

/// Brings `wanted` inside: vx and vy are shortened together, their direction kept, to the ellipses
/// through the largest speeds; the yaw rate is clamped. Continuous in `wanted`, which is finite.
inline EnvelopedCommand bring_inside(const VelocityCommand& wanted,
                                     const CommandEnvelope& envelope) noexcept {
  EnvelopedCommand inside{.command = wanted};
  // Value over its limit. What has no limit of its own is not to be had at all.
  const auto part = [&](double& value, double limit) {
    if (value == 0.0 || limit > 0.0) return value == 0.0 ? 0.0 : value / limit;
    value = inside.share = 0.0;
    return 0.0;
  };
  VelocityCommand& c = inside.command;
  const double x = part(c.vx_mps, c.vx_mps < 0.0 ? envelope.backward_mps : envelope.forward_mps);
  const double y = part(c.vy_mps, envelope.lateral_mps);
  const double yaw = std::fabs(part(c.wz_radps, envelope.yaw_radps));
  const double r2 = x * x + y * y;
  if (r2 > 1.0) {
    const double share = 1.0 / std::sqrt(r2);
    c.vx_mps *= share;
    c.vy_mps *= share;
    inside.share = std::min(inside.share, share);
  }
  if (yaw > 1.0) {
    c.wz_radps = std::copysign(envelope.yaw_radps, c.wz_radps);
    inside.share = std::min(inside.share, 1.0 / yaw);
  }
  return inside;
}

/// Next value on the way from `current` to `wanted`, at most `max_step` away from `current`.
/// Arrives at exactly `wanted`; an infinite `max_step` passes `wanted` through.
template <typename Scalar>
Scalar slew(const Scalar& current, const Scalar& wanted, const Scalar& max_step) {
  return clamp_to<Scalar>(wanted, current - max_step, current + max_step);
}

}  // namespace sandrunner
