// SPDX-License-Identifier: BSD-3-Clause
// Rotations as unit quaternions (w, x, y, z).
#pragma once

#include <array>
#include <cmath>

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

/// A vector of the rotated frame in the frame that it is rotated from.
inline Vector3 rotated(const Rotation& q, const Vector3& v) noexcept {
  const auto [w, x, y, z] = q;
  return {(1.0 - 2.0 * (y * y + z * z)) * v[0] + 2.0 * (x * y - w * z) * v[1] +
              2.0 * (x * z + w * y) * v[2],
          2.0 * (x * y + w * z) * v[0] + (1.0 - 2.0 * (x * x + z * z)) * v[1] +
              2.0 * (y * z - w * x) * v[2],
          2.0 * (x * z - w * y) * v[0] + 2.0 * (y * z + w * x) * v[1] +
              (1.0 - 2.0 * (x * x + y * y)) * v[2]};
}

}  // namespace sandrunner
