// SPDX-License-Identifier: BSD-3-Clause
// The law of granular ground: Aguilar & Goldman's developing cone as the paper generalises it
// (section S11), its plastic memory, the moving average of the normal force (eq. S16), and the
// horizontal stroke resistance (paper, eqs. 1 and 2). Beyond the paper: firmer ground below
// (layer_growth()), and on demand less force on what moves sideways or is turned away
// (share_of_direction()). Where the paper's text and its authors' code differ, the code is
// followed, since the published network was trained with it: the filter's constants, ungated
// friction, depth term z - r_f, stroke resistance that begins beyond the crater's radius and counts
// horizontal travel as fresh ground (the paper's text: any overlap with the wall, and its greatest
// value so far).
#pragma once

#include <numbers>

#include "rt/base/settings.h"
#include "sim/ground/law.h"

namespace sandrunner::sim {

/// Defaults are those of the paper authors' code for its sand demonstration. Symbols as in Aguilar
/// & Goldman 2016 as generalised by the paper (section S11) and its HSR model (eqs. 1, 2); sigma in
/// N/m^3.
struct GranularParameters {
  static constexpr const char* kName = "granular";
  // Developing cone.
  double sigma_flat_npm3 = 1.0e6;              ///< stress gradient on the flat face
  double sigma_cone_npm3 = 0.2e6;              ///< stress gradient on the cone's side
  double recruitment = 2.0;                    ///< nu: cone height gained per depth
  double cone_angle_rad = 1.0471975511965976;  ///< theta, from the horizontal
  double mass_scaling = 2.7;                   ///< c_g: grains moved outside the cone
  double packing = 0.57;                       ///< phi: volume fraction
  double grain_density_kgpm3 = 1000.0;         ///< rho
  double drag = 17.2;                          ///< c_d: inertial drag scaling
  double plastic_tolerance_m = 1e-4;           ///< eps_f
  // Horizontal stroke resistance.
  double stroke_stiffness_npm = 160.0;           ///< k_h
  double stroke_damping_nspm = 1.0;              ///< b_h
  double stroke_depth_scaling = 0.5;             ///< beta_d
  double crater_radius_m = 0.05;                 ///< r_c
  double crater_angle_rad = 0.7853981633974483;  ///< gamma_c
  // Firmer ground below.
  double layer_depth_m = 0.0;    ///< H; 0: there is none
  double layer_strength = 10.0;  ///< its stress gradients over those above

  // Effects, each of which can be switched off for an ablation.
  bool inertial_drag = true;  ///< c_d m_a' z_dot
  bool added_mass = true;     ///< m_a z_ddot
  bool plastic_memory =
      true;  ///< force only beyond the remembered depth (else whenever the foot goes down)
  bool healing = true;  ///< the remembered depth heals as the foot moves sideways
  bool filter = true;   ///< moving average of the normal force (eq. S16)
  bool stroke_resistance = true;
  bool gated_friction =
      false;               ///< friction only while the normal force acts (authors' code: always)
  bool direction = false;  ///< quasistatic normal force by direction and tilt

  using P = GranularParameters;
  static constexpr Setting<P> kSettings[] = {
      {"sigma_flat_npm3", &P::sigma_flat_npm3, 1.0, 1e10,
       "Granular: stress gradient on the flat face of the cone of grains."},
      {"sigma_cone_npm3", &P::sigma_cone_npm3, 1.0, 1e10,
       "Granular: stress gradient on the side of the cone."},
      {"recruitment", &P::recruitment, 0.01, 20.0,
       "Granular: height that the cone gains per depth."},
      {"cone_angle_deg", degrees(&P::cone_angle_rad), 5.0, 85.0,
       "Granular: angle of the cone from the horizontal."},
      {"mass_scaling", &P::mass_scaling, 0.0, 20.0,
       "Granular: grains that move, over those in the cone."},
      {"packing", &P::packing, 0.0, 1.0, "Granular: volume fraction of the grains."},
      {"grain_density_kgpm3", &P::grain_density_kgpm3, 0.0, 2e4,
       "Granular: density of the grains' material."},
      {"drag", &P::drag, 0.0, 1e3, "Granular: scale of the inertial drag."},
      {"plastic_tolerance_m", &P::plastic_tolerance_m, 0.0, 0.01,
       "Granular: the force begins this much above the remembered depth; over firmer ground at "
       "least "
       "0.3 mm."},
      {"stroke_stiffness_npm", &P::stroke_stiffness_npm, 0.0, 1e5,
       "Granular: stiffness against a foot that moves sideways."},
      {"stroke_damping_nspm", &P::stroke_damping_nspm, 0.0, 1e3,
       "Granular: damping against a foot that moves sideways."},
      {"stroke_depth_scaling", &P::stroke_depth_scaling, 0.0, 10.0,
       "Granular: weight of the depth in the resistance against moving sideways."},
      {"crater_radius_m", &P::crater_radius_m, 0.0, 1.0,
       "Granular: radius of the crater of a foot."},
      {"crater_angle_deg", degrees(&P::crater_angle_rad), 5.0, 85.0,
       "Granular: slope of the crater's wall."},
      {"layer_depth_m", &P::layer_depth_m, 0.0, 10.0,
       "Granular: where firmer ground begins; 0: nowhere."},
      {"layer_strength", &P::layer_strength, 1.0, 25.0,
       "Granular: stress gradients of the firmer ground over those above it."},
      {"effects.inertial_drag", &P::inertial_drag, "Granular: drag of moving grains."},
      {"effects.added_mass", &P::added_mass, "Granular: inertia of moving grains."},
      {"effects.plastic_memory", &P::plastic_memory,
       "Granular: force only beyond the depth that is remembered."},
      {"effects.healing", &P::healing,
       "Granular: the remembered depth heals as the foot moves sideways."},
      {"effects.filter", &P::filter, "Granular: moving average of the normal force."},
      {"effects.stroke_resistance", &P::stroke_resistance,
       "Granular: resistance against a foot that moves sideways."},
      {"effects.gated_friction", &P::gated_friction,
       "Granular: friction only while the normal force acts."},
      {"effects.direction", &P::direction,
       "Granular: less normal force on a foot that moves sideways, and on a sole at an angle."},
  };
};

template <typename S>
struct GranularLaw {
  using Parameters = GranularParameters;
  static constexpr bool kHard = false, kRemembers = true, kDrawnAsSand = true;
  S sigma_flat{}, sigma_cone{};  ///< N/m^3
  S k{};                         ///< nu / tan(theta)
  S k2_third{};                  ///< k^2/3
  S inverse_cos{};               ///< 1/cos(theta)
  S full_depth{};                ///< z_c, at which the lower flat has vanished, m
  S full_flat{};                 ///< I_flat(z_c), m^3
  S added_mass{};                ///< c_g phi rho nu (per I_flat), kg/m^3; 0: no added mass
  S drag{};                      ///< c_d c_g phi rho nu (per A_flat), kg/m^3; 0: no drag
  S memory{};                    ///< 1: plastic memory, 0: none
  S tolerance{};                 ///< eps_f, m
  S healing_slope{};             ///< tan(gamma_c), 0: no healing
  S crater_radius{};             ///< r_c, m
  S filter_step{};               ///< c_r, what tau_r gains at a reversal; 0: no filter
  S friction_gated{};            ///< 1: friction only while the normal force acts
  S directed{};                  ///< 1: force by direction and tilt
  S stroke_stiffness{}, stroke_damping{}, stroke_depth_scaling{};  ///< k_h, b_h, beta_d
  S stroke_offset{};  ///< r_f/sin(gamma_c) - r_c - r_f/tan(gamma_c), m
  S inverse_tan_crater{};
  S layer_depth{};         ///< H, m; 0: no layer
  S layer_log_strength{};  ///< ln of the layer's strength
  S layer_log_slope{};     ///< what it loses per height over the layer, 1/m

  FootForce<S> step(const FootProfile<S>& foot, S friction, const FootMotion<S>& motion, S rate_hz,
                    FootContact<S>& contact) const noexcept;
};

GranularLaw<double> derive_law(const GranularParameters& parameters,
                               const FootProfile<double>& foot, double foot_radius_m);

/// Cone integrals at depth z (m) of a foot with the given P0, P1 (m^3; see FootProfile).
template <typename S>
struct Cone {
  S flat_integral;  ///< I_flat, m^3
  S cone_integral;  ///< I_cone, m^3
};
template <typename S>
inline Cone<S> cone_integrals(const GranularLaw<S>& g, S z, S p0, S p1) noexcept {
  const S pi = S(std::numbers::pi);
  // pi (P0 - 2 k P1 + k^2 z^3 / 3)
  const S growing = pi * fma(z * (z * z), g.k2_third, fma(S(-2.0) * g.k, p1, p0));
  const S flat = select(z < g.full_depth, growing, g.full_flat);
  return {flat, fma(pi, p0, -flat) * g.inverse_cos};
}
/// Area of the lower flat at depth z, m^2: pi max(0, r_h - k z)^2.
template <typename S>
inline S flat_area(const GranularLaw<S>& g, S z, S hydraulic_radius) noexcept {
  const S r = max(fma(-g.k, z, hydraulic_radius), S(0.0));
  return S(std::numbers::pi) * (r * r);
}
/// Quasistatic force F_p = sigma_flat I_flat + sigma_cone I_cone of ground without a layer, N.
template <typename S>
inline S quasistatic_force(const GranularLaw<S>& g, const Cone<S>& c) noexcept {
  return fma(g.sigma_flat, c.flat_integral, g.sigma_cone * c.cone_integral);
}
/// By how much firmer ground below makes the ground stiffer at depth z, m. What a foot of width B
/// breaks reaches H_cr = B e^((pi/4 + phi/2) tan phi) / (2 cos(pi/4 + phi/2)) below it, phi the
/// angle of friction (as of a strip footing: Fundamentals of Foundation Engineering, eq. 5.35).
/// From there on the strength rises exponentially to that of the layer (as the force on what is
/// pushed towards a bottom: Lopez-Rodriguez & Pacheco-Vazquez, PRE 96 030901), which it has from H
/// on.
template <typename S>
inline S layer_growth(const GranularLaw<S>& g, S z) noexcept {
  const S zero = S(0.0);
  const S above = max(g.layer_depth - z, zero);
  const S growth = exponential(max(fma(-g.layer_log_slope, above, g.layer_log_strength), zero));
  return select(g.layer_depth > zero, growth, S(1.0));
}

/// The normal force on a foot over that on a level one that moves straight down, as resistive force
/// theory has it for all dry sands alike: alpha_z(beta, gamma) of the generic coefficients (Li,
/// Zhang & Goldman, Science 339, 1408), which is 1 there. gamma: angle of the motion from the
/// horizontal; beta: of the sole, whose sign is that of its rise along the motion. Below 1 cm/s
/// sideways the motion loses its direction, so that a foot at rest stands as without.
template <typename S>
inline S share_of_direction(const FootMotion<S>& m) noexcept {
  const S one = S(1.0), slow = S(0.01);
  const S along2 = fma(m.vx, m.vx, m.vy * m.vy), down2 = fma(m.v, m.v, slow * slow);
  const S inverse = one / sqrt(down2 + along2);
  const S sin_gamma = sqrt(down2) * inverse;
  const S cos2_beta = one / fma(m.tilt_x, m.tilt_x, fma(m.tilt_y, m.tilt_y, one));
  const S cos_2beta = fma(S(2.0), cos2_beta, -one);
  const S rise = fma(m.tilt_x, m.vx, m.tilt_y * m.vy) * inverse;  // tan(beta) cos(gamma)
  // A00 + A10 cos(2 beta) + B01 sin(gamma) + B11 sin(gamma + 2 beta) + B-11 sin(gamma - 2 beta)
  const S straight = fma(S(0.212 + 0.055), cos_2beta, S(0.358));
  const S sideways = S(2.0 * (0.212 - 0.055)) * (cos2_beta * rise);
  return max(fma(S(0.169), cos_2beta, S(0.206)) + fma(straight, sin_gamma, sideways), S(0.0));
}

/// Quasistatic force at depth z >= 0 of a foot, N.
template <typename S>
inline S quasistatic_force(const GranularLaw<S>& g, const FootProfile<S>& foot, S z) noexcept {
  S p0, p1;
  foot.integrals(z, p0, p1);
  return quasistatic_force(g, cone_integrals(g, z, p0, p1)) * layer_growth(g, z);
}

template <typename S>
inline FootForce<S> GranularLaw<S>::step(const FootProfile<S>& foot, S friction,
                                         const FootMotion<S>& motion, S rate_hz,
                                         FootContact<S>& contact) const noexcept {
  const S zero = S(0.0), one = S(1.0);
  const GranularLaw<S>& g = *this;
  FootContact<S>& c = contact;
  const auto& [x, y, z, v, vx, vy, pressed, tilt_x, tilt_y] = motion;
  const Mask<S> touching = z >= zero;
  const Mask<S> touchdown = both(touching, c.active == zero);
  const S v_before = c.velocity;
  c.velocity = v;
  const auto reset = [&](S& field, S value) { field = select(touchdown, value, field); };
  reset(c.memory_depth, zero);
  reset(c.memory_x, x);
  reset(c.memory_y, y);
  reset(c.memory_travel, zero);
  reset(c.restart_flat, zero);
  reset(c.filter, zero);
  reset(c.force, zero);
  reset(c.stroke_latched, zero);
  c.active = select(touching, one, zero);

  const S depth = max(z, zero) + pressed;
  S p0, p1;
  foot.integrals(depth, p0, p1);
  const Cone<S> cone = cone_integrals(g, depth, p0, p1);
  S quasistatic = quasistatic_force(g, cone);
  if (any(g.layer_depth > zero)) quasistatic = quasistatic * layer_growth(g, depth);
  const S area = flat_area(g, depth, foot.hydraulic_radius(depth));

  // Plastic memory: force only on the way down, and only from the remembered depth on.
  const Mask<S> beyond = z >= (c.memory_depth - g.tolerance) * g.memory;
  const Mask<S> pushing = both(touching, both(v > zero, beyond));
  const S memory_before = c.memory_depth;
  const Mask<S> deeper = both(touching, z > c.memory_depth);
  c.memory_depth = select(deeper, z, c.memory_depth);
  c.memory_x = select(deeper, x, c.memory_x);
  c.memory_y = select(deeper, y, c.memory_y);
  c.memory_travel = select(deeper, zero, c.memory_travel);

  // Horizontal distance to the crater's centre, and the overlap of the foot with the crater's wall
  // (eq. 1).
  const S mx = x - c.memory_x, my = y - c.memory_y;
  const S travel = sqrt(fma(mx, mx, my * my));
  const S overlap = (travel + g.stroke_offset) - (c.memory_depth - z) * g.inverse_tan_crater;
  // A foot that leaves its crater climbs the wall: the remembered depth heals.
  const S further = max(travel - max(c.memory_travel, g.crater_radius), zero);
  c.memory_travel = max(c.memory_travel, travel);
  const S marker_depth = c.memory_depth;
  c.memory_depth = max(fma(-g.healing_slope, further, c.memory_depth), zero);
  // Ploughing into the wall starts a new cone, once per contact.
  const Mask<S> latch = both(both(touching, both(travel > g.crater_radius, overlap > zero)),
                             both(c.stroke_latched == zero, g.stroke_stiffness > zero));
  c.stroke_latched = select(latch, one, c.stroke_latched);
  c.stroke_x = select(latch, c.memory_x, c.stroke_x);
  c.stroke_y = select(latch, c.memory_y, c.stroke_y);
  c.stroke_depth = select(latch, marker_depth, c.stroke_depth);
  c.stroke_travel = select(latch, S(-1.0), c.stroke_travel);
  c.restart_flat = select(latch, cone.flat_integral, c.restart_flat);
  c.filter = select(latch, zero, c.filter);

  // F = F_p + c_d (dm_a/dz) v^2 + m_a dv/dt  (S15, z down), gated, filtered (S16), never pulling.
  const S acceleration = (v - v_before) * rate_hz;
  const S mass = g.added_mass * max(cone.flat_integral - c.restart_flat, zero);
  S resistance = quasistatic;
  if (any(g.directed > zero)) {
    resistance = select(g.directed > zero, quasistatic * share_of_direction(motion), quasistatic);
  }
  S raw = fma(g.drag * area, v * v, fma(mass, acceleration, resistance));
  // Over firmer ground the whole force at once, within the tolerance above the remembered depth,
  // would throw a light foot up: there it rises over the tolerance, as from the bottom of a print.
  if (any(g.layer_depth > zero)) {
    const S above_memory = (z - memory_before) + g.tolerance;
    const S within = select(pressed > zero, min(above_memory, z), above_memory);
    const Mask<S> again = both(both(g.layer_depth > zero, g.memory > zero), within < g.tolerance);
    raw = select(again, raw * (within / g.tolerance), raw);
  }
  FootForce<S> f;
  f.raw = select(pushing, raw, zero);
  c.filter = select(v * v_before < zero, min(c.filter + g.filter_step, one), c.filter);
  const S weight = S(0.8) * c.filter;
  f.normal = select(touching, max(fma(weight, c.force - f.raw, f.raw), zero), zero);
  // A force that fades away would become a denormal number, which not every processor flushes.
  f.normal = select(f.normal > S(1e-30), f.normal, zero);
  c.force = f.normal;
  f.friction_bound = select(both(touching, either(pushing, g.friction_gated == zero)),
                            friction * quasistatic, zero);

  // Stroke resistance: only beyond the latched crater, only into fresh ground, only when buried
  // deeper than a radius.
  const S sx = x - c.stroke_x, sy = y - c.stroke_y;
  const S stroke_travel = sqrt(fma(sx, sx, sy * sy));
  const S stroke_overlap =
      (stroke_travel + g.stroke_offset) - (c.stroke_depth - z) * g.inverse_tan_crater;
  const Mask<S> ploughing =
      both(both(c.stroke_latched == one, touching),
           both(both(stroke_overlap > zero, z > foot.radius),
                both(stroke_travel > c.stroke_travel, stroke_travel > S(1e-6))));
  if (any(ploughing)) {
    const S inverse = one / max(stroke_travel, S(1e-6));
    f.direction_x = sx * inverse;
    f.direction_y = sy * inverse;
    const S outward = max(fma(vx, f.direction_x, vy * f.direction_y), zero);
    const S spring = max(
        g.stroke_stiffness * fma(g.stroke_depth_scaling, z - foot.radius, stroke_overlap), zero);
    f.stroke = select(ploughing, fma(g.stroke_damping, outward, spring), zero);
  }
  c.stroke_travel = select(touching, max(c.stroke_travel, stroke_travel), c.stroke_travel);
  return f;
}

}  // namespace sandrunner::sim
