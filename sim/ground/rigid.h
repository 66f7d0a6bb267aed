// SPDX-License-Identifier: BSD-3-Clause
// Hard ground: the contact problem finds the forces on the foot.
#pragma once

#include <span>

#include "rt/base/settings.h"
#include "sim/ground/law.h"

namespace sandrunner::sim {

struct RigidParameters {
  static constexpr const char* kName = "rigid";
  static constexpr std::span<const Setting<RigidParameters>> kSettings{};
};

template <typename S>
struct RigidLaw {
  using Parameters = RigidParameters;
  static constexpr bool kHard = true, kRemembers = false, kDrawnAsSand = false;
};

inline RigidLaw<double> derive_law(const RigidParameters&, const FootProfile<double>&,
                                   double) noexcept {
  return {};
}

}  // namespace sandrunner::sim
