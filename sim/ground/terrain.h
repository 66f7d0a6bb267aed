// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <tuple>
#include <type_traits>

#include "sim/ground/ground.h"
#include "sim/lanes/vec.h"

namespace sandrunner::sim {

inline constexpr int kMaxRegions = 8;

/// Patches of ground one after the other along x; the last one is endless. All members are S, so
/// that a pack's terrain is an array of its robots' terrains.
template <typename S>
struct Terrain {
  S count = S(1.0);
  std::array<Ground<S>, kMaxRegions> ground;
  std::array<S, kMaxRegions>
      start_x{};  ///< where patch i begins, m; ascending, that of patch 0 is ignored
  /// Upper bound of the surface's height, m: 0 without roughness.
  S highest{};
  S coupled{};  ///< 1: feet on some patch share a pressure

  /// Index of the patch at x.
  S region_at(S x) const noexcept {
    S index = S(0.0);
    if (!any(count > S(1.0))) return index;
    for (int i = 1; i < kMaxRegions; ++i) {
      index = select(both(x >= start_x[i], count > S(double(i))), S(double(i)), index);
    }
    return index;
  }
  /// The patch of each lane; where lanes stand on different patches, they are put together in
  /// `scratch`.
  const Ground<S>& pick(S index, Ground<S>& scratch) const noexcept {
    if constexpr (std::is_floating_point_v<S>) {
      return ground[static_cast<std::size_t>(index)];
    } else {
      if (!any(index > S(0.0))) return ground[0];
      using Fields = std::array<S, sizeof(Ground<S>) / sizeof(S)>;
      Fields fields = std::bit_cast<Fields>(ground[0]);
      for (int i = 1; i < kMaxRegions; ++i) {
        const Mask<S> here = index == S(double(i));
        if (!any(here)) continue;
        const Fields other = std::bit_cast<Fields>(ground[i]);
        for (std::size_t f = 0; f < fields.size(); ++f) {
          fields[f] = select(here, other[f], fields[f]);
        }
      }
      scratch = std::bit_cast<Ground<S>>(fields);
      return scratch;
    }
  }
};

/// Upper bound of the surface's height, m, where the ground's roughness is `roughness`: six waves
/// of amplitude roughness/sqrt(3) can add up to no more than this.
constexpr double highest_of(double roughness) noexcept { return roughness * 3.4641016151377544; }

/// The same terrain in another scalar.
template <typename To>
Terrain<To> convert_terrain(const Terrain<double>& from) noexcept {
  using From = std::array<double, sizeof(Ground<double>) / sizeof(double)>;
  using Values = std::array<To, std::tuple_size_v<From>>;
  Terrain<To> to;
  to.count = To(from.count);
  to.highest = To(from.highest);
  to.coupled = To(from.coupled);
  for (int i = 0; i < kMaxRegions; ++i) {
    const From values = std::bit_cast<From>(from.ground[i]);
    Values converted;
    for (std::size_t f = 0; f < values.size(); ++f) converted[f] = To(values[f]);
    to.ground[i] = std::bit_cast<Ground<To>>(converted);
    to.start_x[i] = To(from.start_x[i]);
  }
  return to;
}

/// The undisturbed surface at a point: height, m, and gradient. Zeros where it is even.
template <typename S>
struct Surface {
  S height{}, slope_x{}, slope_y{};
};

/// That of a patch of ground at (x, y), world, m.
template <typename S>
Surface<S> surface_at(const Ground<S>& ground, S x, S y) noexcept {
  const S zero = S(0.0);
  Surface<S> s{zero, zero, zero};
  const Mask<S> rough = ground.roughness > zero;
  if (!any(rough)) return s;
  rough_surface(ground, x, y, s.height, s.slope_x, s.slope_y);
  return {select(rough, s.height, zero), select(rough, s.slope_x, zero),
          select(rough, s.slope_y, zero)};
}
/// That of a terrain. S: float or double.
template <typename S>
Surface<S> surface_at(const Terrain<S>& terrain, S x, S y) noexcept {
  return surface_at(terrain.ground[static_cast<std::size_t>(terrain.region_at(x))], x, y);
}

/// Axes of the contact frame: n is the surface's normal, t1 the tangent nearest to world x,
/// t2 = n x t1; all in the world frame.
template <typename S>
struct SurfaceAxes {
  Vec3<S> t1, t2, n;
};
template <typename S>
SurfaceAxes<S> surface_axes(const Surface<S>& surface) noexcept {
  const S one = S(1.0);
  const S &x = surface.slope_x, &y = surface.slope_y;
  const S n = one / sqrt(fma(x, x, fma(y, y, one)));
  const Vec3<S> normal{-(x * n), -(y * n), n};
  const S t = one / sqrt(fma(x, x, one));
  const Vec3<S> tangent{t, S(0.0), x * t};
  return {tangent, cross(normal, tangent), normal};
}

}  // namespace sandrunner::sim
