// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "sim/ground/shape.h"
#include "sim/robot/dynamics.h"

namespace sandrunner::sim {

/// Whether a simulation is lost: it is not a number, or faster or higher than any robot (speeds
/// that add up to 100 m/s and rad/s, 10 m over the ground or below it). The contact flags of a step
/// do not show it: comparisons with nan are false.
inline bool diverged(const RigidState<float>& x, const Shape<float>& shape) noexcept {
  const float speed = std::fabs(x.velocity.x) + std::fabs(x.velocity.y) + std::fabs(x.velocity.z) +
                      std::fabs(x.angular_velocity.x) + std::fabs(x.angular_velocity.y) +
                      std::fabs(x.angular_velocity.z);
  return !(speed < 100.0f) || !(std::fabs(shape.over_plane(x.position)) < 10.0f + shape.crest);
}

}  // namespace sandrunner::sim
