// SPDX-License-Identifier: BSD-3-Clause
#include "sim/ground/granular.h"

#include <algorithm>
#include <numbers>

namespace sandrunner::sim {
namespace {

// ln x for 1 <= x <= 25, in the arithmetic of exponential(): Halley's iteration, which comes from
// below.
double logarithm(double x) {
  double y = 0.0;
  for (int i = 0; i < 10; ++i) {
    const double e = exponential(y);
    y += 2.0 * (x - e) / (x + e);
  }
  return y;
}

// H_cr of layer_growth() on ground of friction angle phi, for a foot of width B (m), m.
double rupture_depth(double friction_rad, double width_m) {
  double sine, cosine, sine_half, cosine_half;
  sincos(friction_rad, sine, cosine);
  const double half = 0.25 * std::numbers::pi + 0.5 * friction_rad;
  sincos(half, sine_half, cosine_half);
  return width_m * exponential(half * sine / cosine) / (2.0 * cosine_half);
}

}  // namespace

GranularLaw<double> derive_law(const GranularParameters& p, const FootProfile<double>& foot,
                               double foot_radius_m) {
  GranularLaw<double> g;
  g.sigma_flat = p.sigma_flat_npm3;
  g.sigma_cone = p.sigma_cone_npm3;
  double sine, cosine;
  sincos(p.cone_angle_rad, sine, cosine);
  g.k = p.recruitment * cosine / sine;
  g.k2_third = g.k * g.k / 3.0;
  g.inverse_cos = 1.0 / cosine;
  // z_c: the cone's radius r_h(z) - k z falls to zero once; beyond the radius r_h is constant.
  double low = 0.0, high = foot.buried_radius / g.k + foot.radius;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (foot.hydraulic_radius(middle) > g.k * middle ? low : high) = middle;
  }
  g.full_depth = 0.5 * (low + high);
  double p0, p1;
  foot.integrals(g.full_depth, p0, p1);
  const double z3 = g.full_depth * g.full_depth * g.full_depth;
  g.full_flat = std::numbers::pi * (p0 - 2.0 * g.k * p1 + g.k2_third * z3);
  const double recruited = p.mass_scaling * p.packing * p.grain_density_kgpm3 * p.recruitment;
  g.added_mass = p.added_mass ? recruited : 0.0;
  g.drag = p.inertial_drag ? p.drag * recruited : 0.0;
  g.memory = p.plastic_memory ? 1.0 : 0.0;
  // Over firmer ground a light foot would bounce within less.
  constexpr double kLayerTolerance_m = 3e-4;
  g.tolerance = p.layer_depth_m > 0.0 ? std::max(p.plastic_tolerance_m, kLayerTolerance_m)
                                      : p.plastic_tolerance_m;
  sincos(p.crater_angle_rad, sine, cosine);
  g.healing_slope = p.healing ? sine / cosine : 0.0;
  g.crater_radius = p.crater_radius_m;
  // c_r = 100 / f_sim (eq. S16): the filter's memory grows to its full length over 40 reversals at
  // 4 kHz.
  g.filter_step = p.filter ? 100.0 * 0.25e-3 : 0.0;
  g.friction_gated = p.gated_friction ? 1.0 : 0.0;
  g.directed = p.direction ? 1.0 : 0.0;
  g.stroke_stiffness = p.stroke_resistance ? p.stroke_stiffness_npm : 0.0;
  g.stroke_damping = p.stroke_resistance ? p.stroke_damping_nspm : 0.0;
  g.stroke_depth_scaling = p.stroke_depth_scaling;
  g.stroke_offset = foot_radius_m / sine - p.crater_radius_m - foot_radius_m * cosine / sine;
  g.inverse_tan_crater = cosine / sine;
  // The cone's side stands at pi/4 + phi/2.
  const double friction =
      std::clamp(2.0 * p.cone_angle_rad - 0.5 * std::numbers::pi, 0.0, 0.25 * std::numbers::pi);
  g.layer_depth = p.layer_depth_m;
  g.layer_log_strength = logarithm(p.layer_strength);
  g.layer_log_slope = g.layer_log_strength / rupture_depth(friction, 2.0 * foot.radius);
  return g;
}

}  // namespace sandrunner::sim
