// SPDX-License-Identifier: BSD-3-Clause
#include "sim/ground/foot_profile.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "sim/lanes/lanes.h"

namespace sandrunner::sim {
namespace {

// All in double, with the simulator's own cosine: `long double` has 80 bits on x86-64 and 128 on
// arm64, and libm's last bit depends on the machine. The coefficients, and so every hash and every
// trained weight, must not.
double cosine(double angle_rad) {
  double sine, cosine;
  sincos(angle_rad, sine, cosine);
  return cosine;
}

// Coefficients of the polynomial in x = 2 s - 1 of degree n that interpolates f(s) at the Chebyshev
// points of [0, 1].
template <typename F>
void interpolate(const F& f, int n, double* coefficients) {
  constexpr double kPi = std::numbers::pi;
  std::vector<double> value(n + 1), chebyshev(n + 1, 0.0);
  for (int i = 0; i <= n; ++i) {
    value[i] = f(0.5 * (1.0 + cosine(kPi * (i + 0.5) / (n + 1))));
  }
  for (int k = 0; k <= n; ++k) {
    for (int i = 0; i <= n; ++i) chebyshev[k] += value[i] * cosine(kPi * k * (i + 0.5) / (n + 1));
    chebyshev[k] *= (k == 0 ? 1.0 : 2.0) / (n + 1);
  }
  // Chebyshev polynomials as monomials: T_{k+1} = 2 x T_k - T_{k-1}.
  std::vector<double> previous(n + 2, 0.0), current(n + 2, 0.0), sum(n + 1, 0.0);
  previous[0] = 1.0;
  current[1] = 1.0;
  sum[0] = chebyshev[0];
  for (int k = 1; k <= n; ++k) {
    std::vector<double> next(n + 2, 0.0);
    for (int i = 0; i <= k; ++i) {
      sum[i] += chebyshev[k] * current[i];
      next[i + 1] += 2.0 * current[i];
      next[i] -= previous[i];
    }
    previous = current;
    current = next;
  }
  for (int i = 0; i <= n; ++i) coefficients[i] = sum[i];
}

// Integral over [0, b], b <= 1, of a function smooth in s: 16 panels of 5-point Gauss-Legendre.
template <typename F>
double integrate_to(const F& f, double b) {
  constexpr double kNodes[5] = {
      -0.906179845938663992797626878299392965, -0.538469310105683091036314420700208805, 0.0,
      0.538469310105683091036314420700208805, 0.906179845938663992797626878299392965};
  constexpr double kWeights[5] = {
      0.236926885056189087514264040719917363, 0.478628670499366468041291514835638193,
      0.568888888888888888888888888888888889, 0.478628670499366468041291514835638193,
      0.236926885056189087514264040719917363};
  constexpr int kPanels = 16;
  const double half = 0.5 * b / kPanels;
  double sum = 0.0;
  for (int p = 0; p < kPanels; ++p) {
    for (int i = 0; i < 5; ++i) sum += kWeights[i] * f(half * (2 * p + 1 + kNodes[i]));
  }
  return half * sum;
}

}  // namespace

FootProfile<double> fit_foot_profile(FootShape shape, double radius_m, double width_m,
                                     double hydraulic_factor) {
  FootProfile<double> profile;
  profile.radius = radius_m;
  profile.inverse_radius = 1.0 / radius_m;
  profile.tyre_width = width_m;
  profile.hydraulic_factor = hydraulic_factor;
  profile.shape = shape;
  profile.buried_radius = shape == FootShape::kDisc ? 0.5 * hydraulic_factor * radius_m
                                                    : profile.hydraulic_radius(radius_m);
  if (shape == FootShape::kDisc) return profile;
  const double r = radius_m, h = width_m, c = hydraulic_factor;
  // r_h as a function of s = sqrt(z/r); a = r s sqrt(2 - s^2).
  const auto radius_at = [&](double s) {
    const double a = r * s * std::sqrt(2.0 - s * s);
    switch (shape) {
      case FootShape::kTyre:
        return c * a * h / (2.0 * a + h);
      case FootShape::kSphere:
        return 0.5 * c * a;
      case FootShape::kDisc:
        break;
    }
    return 0.5 * c * r;
  };
  // dz = 2 r s ds. P0/s^4 and P1/s^5 are smooth on [0, 1], with finite limits at 0.
  const auto p0 = [&](double s) {
    return integrate_to([&](double u) { return radius_at(u) * radius_at(u) * 2.0 * r * u; }, s) /
           (s * s * s * s);
  };
  const auto p1 = [&](double s) {
    return integrate_to([&](double u) { return r * u * u * radius_at(u) * 2.0 * r * u; }, s) /
           (s * s * s * s * s);
  };
  interpolate(p0, FootProfile<double>::kDegree, profile.p0.data());
  interpolate(p1, FootProfile<double>::kDegree, profile.p1.data());
  return profile;
}

}  // namespace sandrunner::sim
