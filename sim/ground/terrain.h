// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>

#include "sim/ground/ground.h"
#include "sim/ground/shape.h"

namespace sandrunner::sim {

inline constexpr int kMaxRegions = 8;

/// A shape, and patches of ground one after the other along x; the last one is endless. All members
/// are S, so that a pack's terrain is an array of its robots' terrains.
template <typename S>
struct Terrain {
  Shape<S> shape;
  S count = S(1.0);
  std::array<Ground<S>, kMaxRegions> ground;
  std::array<S, kMaxRegions>
      start_x{};  ///< where patch i begins, m; ascending, that of patch 0 is ignored
  S coupled{};    ///< 1: feet on some patch share a pressure

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
      bool begun = false;
      for (int i = 0; i < kMaxRegions; ++i) {
        const Mask<S> here = index == S(double(i));
        if (!any(here)) continue;
        if (!any(no(here))) return ground[i];
        if (begun) {
          assign_where<S>(here, ground[i], scratch);
        } else {
          scratch = ground[i];
        }
        begun = true;
      }
      return scratch;
    }
  }
};

/// Whether some patch keeps footprints. S: float or double.
template <typename S>
bool keeps_footprints(const Terrain<S>& terrain) noexcept {
  for (const Ground<S>& ground : terrain.ground) {
    if (ground.footprints > S(0.0)) return true;
  }
  return false;
}

/// The same terrain in another scalar.
template <typename To>
Terrain<To> convert_terrain(const Terrain<double>& from) noexcept {
  return converted<To>(from);
}

}  // namespace sandrunner::sim
