// SPDX-License-Identifier: BSD-3-Clause
#include "sim/ground/ground.h"

#include <cmath>

namespace sandrunner::sim {

bool GroundParameters::carries_like(const GroundParameters& other) const noexcept {
  bool alike = kind == other.kind;
  Laws::for_each([&]<template <typename> typename Law>(int index) {
    using Own = typename Law<double>::Parameters;
    if constexpr (requires(const Own& p) { p.carries_like(p); }) {
      if (index != static_cast<int>(kind)) return;
      alike = alike && Own::carries_like(other);
    }
  });
  return alike;
}

Ground<double> derive_ground(const GroundParameters& p, const FootProfile<double>& foot,
                             double foot_radius_m) {
  Ground<double> g;
  Laws::for_each([&]<template <typename> typename Law>(int) {
    const typename Law<double>::Parameters& own = p;
    static_cast<Law<double>&>(g) = derive_law(own, foot, foot_radius_m);
  });
  g.kind = static_cast<double>(p.kind);
  g.hard = p.is_hard() ? 1.0 : 0.0;
  g.friction = p.friction;
  Laws::for_each([&]<template <typename> typename Law>(int index) {
    const bool is_own = index == static_cast<int>(p.kind);
    if (is_own && Law<double>::kRemembers && p.footprints) g.footprints = 1.0;
  });
  g.repose = std::tan(p.repose_rad);
  return g;
}

}  // namespace sandrunner::sim
