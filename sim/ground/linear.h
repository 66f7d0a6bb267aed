// SPDX-License-Identifier: BSD-3-Clause
// Ground of springs and dampers under each foot, which may share a pressure.
#pragma once

#include <cmath>

#include "rt/base/settings.h"
#include "sim/ground/law.h"

namespace sandrunner::sim {

struct LinearParameters {
  static constexpr const char* kName = "linear";
  double stiffness_npm = 10.0e3;  ///< k_s
  double damping_nspm = 200.0;    ///< b_s
  /// k_c: feet on such ground share one pressure. Its force on each of them is k_c times the sum of
  /// their depths, from the energy k_c/2 (sum of depths)^2.
  double coupling_npm = 0.0;
  static constexpr Setting<LinearParameters> kSettings[] = {
      {"stiffness_npm", &LinearParameters::stiffness_npm, 1.0, 1e6,
       "Linear: spring under each foot."},
      {"damping_nspm", &LinearParameters::damping_nspm, 0.0, 2e3,
       "Linear: damper under each foot."},
      {"coupling_npm", &LinearParameters::coupling_npm, 0.0, 1e6,
       "Linear: force on each foot per depth of all feet together."},
  };
  bool carries_like(const LinearParameters& other) const noexcept {
    return stiffness_npm == other.stiffness_npm && coupling_npm == other.coupling_npm;
  }
};

template <typename S>
struct LinearLaw {
  using Parameters = LinearParameters;
  static constexpr bool kHard = false, kRemembers = false, kDrawnAsSand = false;
  S stiffness{}, damping{};  ///< k_s, N/m; b_s, N s/m
  S coupling{};  ///< sqrt(k_c), so that feet on patches with different k_c share an energy too

  FootForce<S> step(const FootProfile<S>&, S friction, const FootMotion<S>& foot, S,
                    FootContact<S>&) const noexcept {
    const S zero = S(0.0);
    FootForce<S> f;
    f.uncut = fma(stiffness, foot.z, damping * foot.v);
    f.coupling = coupling;
    f.normal = f.raw = select(foot.z >= zero, max(f.uncut, zero), zero);
    f.friction_bound = friction * f.normal;
    return f;
  }
};

inline LinearLaw<double> derive_law(const LinearParameters& p, const FootProfile<double>&,
                                    double) noexcept {
  return {p.stiffness_npm, p.damping_nspm, std::sqrt(p.coupling_npm)};
}

}  // namespace sandrunner::sim
