// SPDX-License-Identifier: BSD-3-Clause
// The law of mud, beyond the paper: soft clay that has no time to drain. A foot breaks in against
// the bearing capacity of a circular footing and, until it breaks off, is held back by a share of
// that when it rises. Below either limit the mud is elastic and damps by the waves that it
// radiates.
//
// With s_u the undrained shear strength at the foot's deepest point, z its depth, D = 2 foot radii
// (of a tyre too), A the foot's cross-section with the surface, and r = sqrt(A/pi):
//
//   limit      N_c s_u A (1 + sqrt(|v|/v_2)), N_c = 6 (1 + 0.2 z/D) <= 9: Skempton 1951. Speed acts
//              as on a Herschel-Bulkley fluid of exponent 1/2: v_2 = 5 m/s gives 15 % from 0.03 to
//              0.3 m/s; published are 5 to 15 % per tenfold strain rate (Garnier et al. 2007)
//   suction    a share of the limit: 1 under a sealed base (Mana et al. 2013), little where a gap
//              lets water in; 0.5 is chosen
//   stiffness  8 G r: a rigid disc on an incompressible elastic half space
//   damping    6.8 r^2 sqrt(G rho): the same disc's radiation, Lysmer & Richart 1966, nu = 1/2
//   sideways   s_u A under the foot, and (3 + z/2D) s_u a projected area at its side, as at a pile
//              near the surface: Matlock 1970
//
// How far a foot rises until it breaks off, and G/s_u of mud, are chosen: no public number was
// found. Only feet feel the mud; shanks pass through it, and knees and base meet it as hard ground.
//
// It never gives energy: its spring pulls towards a place that moves only towards the foot, and the
// limits only weaken its damper. With steps of dt that needs 4 m > 2 c dt + k dt^2, m the foot's
// mass, which the ranges of the settings keep.
#pragma once

#include <cmath>
#include <numbers>

#include "rt/base/settings.h"
#include "sim/ground/law.h"

namespace sandrunner::sim {

struct MudParameters {
  static constexpr const char* kName = "mud";
  double strength_pa = 2000.0;            ///< s_u at the surface
  double strength_gradient_papm = 1.0e4;  ///< what s_u gains with depth
  double mud_density_kgpm3 = 1600.0;      ///< rho
  double rigidity = 100.0;                ///< G/s_u
  double doubling_speed_mps = 5.0;        ///< v_2
  double suction = 0.5;          ///< limit of a foot that rises over that of one that sinks
  double breakoff_widths = 0.3;  ///< how far a foot rises until it breaks off, D

  using P = MudParameters;
  static constexpr Setting<P> kSettings[] = {
      {"strength_pa", &P::strength_pa, 1.0, 3e4, "Mud: undrained shear strength at the surface."},
      {"strength_gradient_papm", &P::strength_gradient_papm, 0.0, 3e4,
       "Mud: what the strength gains with depth."},
      {"mud_density_kgpm3", &P::mud_density_kgpm3, 0.0, 5e3, "Mud: density."},
      {"rigidity", &P::rigidity, 1.0, 100.0, "Mud: shear modulus over shear strength."},
      {"doubling_speed_mps", &P::doubling_speed_mps, 1e-3, 1e3,
       "Mud: speed at which it resists twice as much."},
      {"suction", &P::suction, 0.0, 1.0,
       "Mud: greatest force on a foot that rises over that on one that sinks; 0: none."},
      {"breakoff_widths", &P::breakoff_widths, 0.01, 10.0,
       "Mud: a foot that has risen by so many of its widths is free."},
  };
};

/// What it remembers in a FootContact: memory_depth, the deepest since touchdown; memory_travel,
/// the deepest since the mud has stuck to the foot, m; stroke_depth, where the foot would be
/// without force; stroke_latched, 1: the foot has broken off.
template <typename S>
struct MudLaw {
  using Parameters = MudParameters;
  static constexpr bool kHard = false, kRemembers = true, kDrawnAsSand = true;
  S strength{}, strength_gradient{};  ///< Pa, Pa/m
  S rigidity{};                       ///< G/s_u
  S radiation{};                      ///< 6.8 sqrt(G/s_u rho)
  S inverse_doubling_speed{};         ///< 1/v_2, s/m
  S suction{};
  S breakoff{};  ///< m

  FootForce<S> step(const FootProfile<S>& foot, S, const FootMotion<S>& motion, S,
                    FootContact<S>& c) const noexcept {
    const S zero = S(0.0), one = S(1.0), pi = S(std::numbers::pi);
    const S z = motion.z, v = motion.v;
    const Mask<S> touching = z >= zero;
    const Mask<S> touchdown = both(touching, c.active == zero);
    const auto reset = [&](S& field) { field = select(touchdown, zero, field); };
    reset(c.memory_depth);
    reset(c.memory_travel);
    reset(c.stroke_depth);
    reset(c.stroke_latched);
    c.active = select(touching, one, zero);
    c.velocity = v;

    const S depth = max(z, zero), width = S(2.0) * foot.radius;
    const S area = foot.area(depth), radius = sqrt(area * S(1.0 / std::numbers::pi));
    const S below = depth + motion.pressed;
    const S s_u = fma(strength_gradient, below, strength);
    const S bearing = min(fma(S(0.6) * foot.inverse_radius, below, S(6.0)), S(9.0));
    const S faster = one + sqrt(abs(v) * inverse_doubling_speed);
    const S limit = bearing * faster * (s_u * area);
    const S stiffness = S(8.0) * rigidity * (s_u * radius);
    const S yield = bearing * faster * (pi * radius) / (S(8.0) * rigidity);  // limit/stiffness

    // What bears the foot yields downwards at once and, while it sticks to the foot, upwards.
    S free = max(c.stroke_depth, z - yield);
    const Mask<S> sticks_again = both(c.stroke_latched == one, z > free);
    c.memory_depth = max(c.memory_depth, z);
    c.memory_travel = max(select(sticks_again, z, c.memory_travel), z);
    const Mask<S> off =
        both(no(sticks_again), either(c.stroke_latched == one, c.memory_travel - z > breakoff));
    const Mask<S> loose = either(off, suction == zero);
    free = select(loose, free, min(free, fma(suction, yield, z)));
    c.stroke_depth = select(touching, free, c.stroke_depth);
    c.stroke_latched = select(off, one, zero);

    const S elastic = stiffness * (z - free);
    const S trial = fma(radiation * (area * S(1.0 / std::numbers::pi)), sqrt(s_u) * v, elastic);
    const S least = select(loose, zero, -(suction * limit));
    const Mask<S> apart = both(loose, elastic < zero);
    FootForce<S> f;
    f.normal = select(both(touching, no(apart)), max(min(trial, limit), least), zero);
    f.raw = f.normal;
    // A ball's side, projected: pi/4 of width times depth.
    const S beside = fma(S(0.25) * foot.inverse_radius, depth, S(3.0));
    const S side = beside * S(0.25) * pi * (width * min(depth, width));
    f.friction_bound = select(touching, s_u * (side + select(apart, zero, area)), zero);
    return f;
  }
};

inline MudLaw<double> derive_law(const MudParameters& p, const FootProfile<double>& foot,
                                 double) noexcept {
  return {.strength = p.strength_pa,
          .strength_gradient = p.strength_gradient_papm,
          .rigidity = p.rigidity,
          .radiation = 6.8 * std::sqrt(p.rigidity * p.mud_density_kgpm3),
          .inverse_doubling_speed = 1.0 / p.doubling_speed_mps,
          .suction = p.suction,
          .breakoff = p.breakoff_widths * 2.0 * foot.radius};
}

}  // namespace sandrunner::sim
