// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

#include "estimator/heading.h"
#include "rt/core/messages.h"

namespace sandrunner {

/// Columns of the rotation from body to world: the body's x, y and z axis in the world, from a unit
/// quaternion (w, x, y, z).
inline std::array<Vector3, 3> body_axes(const std::array<double, 4>& q) noexcept {
  const auto [w, x, y, z] = q;
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
           {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
           {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}}};
}

/// A vector of the body frame in the world frame.
inline Vector3 to_world(const std::array<Vector3, 3>& axes, const Vector3& v) noexcept {
  Vector3 world{};
  for (std::size_t k = 0; k < 3; ++k) {
    world[k] = axes[0][k] * v[0] + axes[1][k] * v[1] + axes[2][k] * v[2];
  }
  return world;
}

/// How the base moves as a command has it.
struct BodyMotion {
  double vx_mps = 0.0, vy_mps = 0.0;  ///< heading frame
  double yaw_rate_radps = 0.0;        ///< about world z
};

/// From the velocity in the world frame and the angular velocity in the body frame.
inline BodyMotion body_motion(const std::array<double, 4>& orientation_wxyz,
                              const Vector3& velocity_mps,
                              const Vector3& angular_velocity_radps) noexcept {
  const std::array<Vector3, 3> axes = body_axes(orientation_wxyz);
  const auto [vx_mps, vy_mps] =
      in_heading_frame<double>({axes[0][0], axes[0][1]}, {velocity_mps[0], velocity_mps[1]});
  return {vx_mps, vy_mps, to_world(axes, angular_velocity_radps)[2]};
}

}  // namespace sandrunner
