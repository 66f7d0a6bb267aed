// SPDX-License-Identifier: BSD-3-Clause
// What the granular model must know of a foot's shape: the hydraulic radius of its cross-section
// with the surface as a function of depth, and two integrals of it that serve any soil.
#pragma once

#include <array>
#include <numbers>

#include "sim/lanes/lanes.h"

namespace sandrunner::sim {

/// Shape of the foot's cross-section A_sub with the undisturbed surface.
enum class FootShape {
  kTyre,    ///< cylinder lying on its side: patch of length 2 a(z) and the tyre's width
  kSphere,  ///< disc of radius a(z)
  kDisc,    ///< flat disc of the foot's radius at every depth
};

/// Hydraulic radius r_h(z) = c_h A/P and its integrals
///   P0(z) = int_0^z r_h^2 dz'   [m^3],   P1(z) = int_0^z z' r_h dz'   [m^3].
/// With k = nu/tan(theta), the cone model's integrals follow for any soil without a table of its
/// own:
///   I_flat = pi (P0 - 2 k P1 + k^2 z^3/3) up to z_c,  I_cone = (pi P0 - I_flat)/cos(theta).
/// Beyond the depth r at which the foot is buried to its centre, r_h is constant; before, with s =
/// sqrt(z/r), P0 = s^4 p0(2 s - 1) and P1 = s^5 p1(2 s - 1), p0 and p1 polynomials fitted to
/// quadrature (relative error below 1e-6; centred, so that they are well conditioned in float too).
template <typename S>
struct FootProfile {
  static constexpr int kDegree = 15;
  S radius{};         ///< r, m
  S buried_radius{};  ///< r_h at z >= r, m
  S inverse_radius{};
  S tyre_width{};        ///< 0: not a tyre
  S hydraulic_factor{};  ///< c_h
  FootShape shape = FootShape::kTyre;
  int patches = 1;  ///< of the foot, which bear equal shares
  std::array<S, kDegree + 1> p0{}, p1{};

  /// r_h at depth z >= 0, m.
  S hydraulic_radius(S z) const noexcept {
    if (shape == FootShape::kDisc) return buried_radius;
    const S zr = min(z, radius);
    const S a = sqrt(zr * (S(2.0) * radius - zr));
    if (shape == FootShape::kSphere) return S(0.5) * (hydraulic_factor * a);
    return (hydraulic_factor * (a * tyre_width)) / fma(S(2.0), a, tyre_width);
  }
  /// Cross-section with the undisturbed surface at depth z >= 0, m^2.
  S area(S z) const noexcept {
    const S zr = shape == FootShape::kDisc ? radius : min(z, radius);
    const S square = zr * (S(2.0) * radius - zr);
    return shape == FootShape::kTyre ? S(2.0) * (sqrt(square) * tyre_width)
                                     : S(std::numbers::pi) * square;
  }
  /// P0 and P1 at depth z >= 0.
  void integrals(S z, S& big_p0, S& big_p1) const noexcept {
    if (shape == FootShape::kDisc) {
      big_p0 = (buried_radius * buried_radius) * z;
      big_p1 = S(0.5) * (buried_radius * (z * z));
      return;
    }
    const S zr = min(z, radius);
    const S over = z - zr;
    const S t = zr * inverse_radius;  // s^2
    const S s = sqrt(t);
    const S x = fma(S(2.0), s, S(-1.0));
    // Odd and even coefficients separately: two chains half as long.
    const S x2 = x * x;
    S u = p0[kDegree], v = p1[kDegree], u_even = p0[kDegree - 1], v_even = p1[kDegree - 1];
    for (int i = kDegree - 2; i > 0; i -= 2) {
      u = fma(u, x2, p0[i]);
      v = fma(v, x2, p1[i]);
      u_even = fma(u_even, x2, p0[i - 1]);
      v_even = fma(v_even, x2, p1[i - 1]);
    }
    u = fma(u, x, u_even);
    v = fma(v, x, v_even);
    const S t2 = t * t;
    big_p0 = fma(buried_radius * buried_radius, over, t2 * u);
    big_p1 = fma(S(0.5) * (buried_radius * (z + zr)), over, (t2 * s) * v);
  }
};

/// Fits a profile. radius, width in m; `hydraulic_factor` c_h: 4 with the tyre patch reproduces the
/// authors' code, 2 with a sphere makes r_h the radius of the disc cut out.
FootProfile<double> fit_foot_profile(FootShape shape, double radius_m, double width_m,
                                     double hydraulic_factor);

template <typename To>
FootProfile<To> convert_profile(const FootProfile<double>& from) noexcept {
  FootProfile<To> to;
  to.radius = To(from.radius);
  to.buried_radius = To(from.buried_radius);
  to.inverse_radius = To(from.inverse_radius);
  to.tyre_width = To(from.tyre_width);
  to.hydraulic_factor = To(from.hydraulic_factor);
  to.shape = from.shape;
  to.patches = from.patches;
  for (int i = 0; i <= FootProfile<To>::kDegree; ++i) {
    to.p0[i] = To(from.p0[i]);
    to.p1[i] = To(from.p1[i]);
  }
  return to;
}

}  // namespace sandrunner::sim
