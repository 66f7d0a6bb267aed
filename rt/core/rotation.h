// SPDX-License-Identifier: BSD-3-Clause
// Rotations as unit quaternions (w, x, y, z).
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "rt/core/messages.h"

namespace sandrunner {

using Rotation = std::array<double, 4>;

/// First `b`, then `a`.
inline Rotation product(const Rotation& a, const Rotation& b) noexcept {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
          a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
          a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

/// `start`, turned by this angle about a unit vector of its own frame.
inline Rotation turned(const Rotation& start, const Vector3& axis, double angle_rad) noexcept {
  const double s = std::sin(0.5 * angle_rad);
  return product(start, {std::cos(0.5 * angle_rad), s * axis[0], s * axis[1], s * axis[2]});
}

/// The rotation back.
inline Rotation inverse(const Rotation& q) noexcept { return {q[0], -q[1], -q[2], -q[3]}; }

/// Columns of the rotation from body to world: the body's x, y and z axis in the world.
inline std::array<Vector3, 3> body_axes(const Rotation& q) noexcept {
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

/// A vector of the rotated frame in the frame that it is rotated from.
inline Vector3 rotated(const Rotation& q, const Vector3& v) noexcept {
  return to_world(body_axes(q), v);
}

}  // namespace sandrunner
