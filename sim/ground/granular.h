// SPDX-License-Identifier: BSD-3-Clause
// The force of granular ground on one foot: Aguilar & Goldman's developing cone as the paper
// generalises it (section S11), its plastic memory, the moving average of the normal force (eq.
// S16), and the horizontal stroke resistance (paper, eqs. 1 and 2). Where the paper's text and its
// authors' code differ, the code is followed, since the published network was trained with it: the
// filter's constants, ungated friction, depth term z - r_f, stroke resistance that begins beyond
// the crater's radius and counts horizontal travel as fresh ground (the paper's text: any overlap
// with the wall, and its greatest value so far).
//
// z is the penetration of the deepest point below the undisturbed surface, positive down; v =
// dz/dt.
#pragma once

#include "sim/ground/ground.h"
#include "sim/lanes/vec.h"

namespace sandrunner::sim {

/// What a foot's contact remembers. All of it is reset when the foot touches down.
template <typename S>
struct FootContact {
  S active{};                ///< 1 from touchdown to lift-off
  S region{};                ///< index of the patch of ground it touched down on
  S velocity{};              ///< v of the previous step, also in the air, m/s
  S memory_depth{};          ///< deepest penetration so far, less what has healed, m
  S memory_x{}, memory_y{};  ///< where that was, world, m
  S memory_travel{};         ///< greatest horizontal distance from there since, m
  S restart_flat{};          ///< I_flat at which the present cone began to grow, m^3
  S filter{};                ///< tau_r of eq. S16
  S force{};                 ///< filtered normal force, N
  S stroke_latched{};        ///< 1: the foot ploughs beyond its crater
  S stroke_x{}, stroke_y{}, stroke_depth{};  ///< crater's centre and depth as latched, m
  S stroke_travel{};                         ///< greatest distance from that centre since, m
};

/// Forces on the foot at one step.
template <typename S>
struct GranularForce {
  S normal{};          ///< filtered, >= 0, N
  S raw{};             ///< before the filter, gated, N
  S friction_bound{};  ///< of the tangential force, N
  S stroke{};          ///< horizontal stroke resistance, N, acts along -(direction_x, direction_y)
  S direction_x{}, direction_y{};  ///< unit vector, world
};

/// One step of the granular law at a foot. (x, y), z, v, (vx, vy): place (world, m), penetration
/// (m), its rate and horizontal velocity (m/s) of the deepest point; `rate_hz`: steps per second.
/// Lanes in which the foot is in the air come out zero; `contact` is updated.
template <typename S>
inline GranularForce<S> granular_step(const Ground<S>& g, const FootProfile<S>& foot, S x, S y, S z,
                                      S v, S vx, S vy, S rate_hz,
                                      FootContact<S>& contact) noexcept {
  const S zero = S(0.0), one = S(1.0);
  FootContact<S>& c = contact;
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

  const S depth = max(z, zero);
  S p0, p1;
  foot.integrals(depth, p0, p1);
  const Cone<S> cone = cone_integrals(g, depth, p0, p1);
  const S quasistatic = quasistatic_force(g, cone);
  const S area = flat_area(g, depth, foot.hydraulic_radius(depth));

  // Plastic memory: force only on the way down, and only from the remembered depth on.
  const Mask<S> beyond = z >= (c.memory_depth - g.tolerance) * g.memory;
  const Mask<S> pushing = both(touching, both(v > zero, beyond));
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
  const S raw = fma(g.drag * area, v * v, fma(mass, acceleration, quasistatic));
  GranularForce<S> f;
  f.raw = select(pushing, raw, zero);
  c.filter = select(v * v_before < zero, min(c.filter + g.filter_step, one), c.filter);
  const S weight = S(0.8) * c.filter;
  f.normal = select(touching, max(fma(weight, c.force - f.raw, f.raw), zero), zero);
  // A force that fades away would become a denormal number, which not every processor flushes.
  f.normal = select(f.normal > S(1e-30), f.normal, zero);
  c.force = f.normal;
  f.friction_bound = select(both(touching, either(pushing, g.friction_gated == zero)),
                            g.friction * quasistatic, zero);

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
