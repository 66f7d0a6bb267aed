// SPDX-License-Identifier: BSD-3-Clause
// The heading frame: z up, x where the base points as seen from above (yaw only).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace sandrunner {

/// A horizontal vector: components along x and y.
template <typename T>
using Horizontal = std::array<T, 2>;

namespace detail {

/// Length of what is seen from above of the base's x axis. Not below 1e-3, so that a base that
/// stands on its nose has a heading of some kind and no nan.
template <typename T>
inline T seen_length(const Horizontal<T>& axis) noexcept {
  return std::max(std::sqrt(axis[0] * axis[0] + axis[1] * axis[1]), static_cast<T>(1e-3));
}

}  // namespace detail

/// Direction of the heading in the world, from the first two components of the base's x axis in the
/// world (first column of the rotation from body to world).
template <typename T>
inline Horizontal<T> heading_direction(const Horizontal<T>& axis) noexcept {
  const T length = detail::seen_length(axis);
  return {axis[0] / length, axis[1] / length};
}

/// Components of a world vector along `direction`, a unit vector, and to its left.
template <typename T>
inline Horizontal<T> components_along(const Horizontal<T>& direction,
                                      const Horizontal<T>& vector) noexcept {
  return {direction[0] * vector[0] + direction[1] * vector[1],
          direction[0] * vector[1] - direction[1] * vector[0]};
}

/// A world vector in the heading frame of a base with this x axis. The same as components_along(
/// heading_direction(axis), vector) but for the rounding of the last bit.
template <typename T>
inline Horizontal<T> in_heading_frame(const Horizontal<T>& axis,
                                      const Horizontal<T>& vector) noexcept {
  const T length = detail::seen_length(axis);
  const Horizontal<T> scaled = components_along(axis, vector);
  return {scaled[0] / length, scaled[1] / length};
}

}  // namespace sandrunner
