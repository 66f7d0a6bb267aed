// SPDX-License-Identifier: BSD-3-Clause
// What a law of force is: how one kind of ground resists a foot. A law is a struct of its own file
// (granular.h is the longest example) with
//   Parameters     what a person writes: kName, its word of `terrain.kind`, and kSettings, a row
//                  for each member; carries_like(), if some of them decide how deep a robot stands,
//   members        constants that derive_law() makes from them, once for a foot; all of them S,
//   step()         the force on one foot at one step,
//   kHard          impenetrable: the contact problem finds the normal force. It has no step(),
//   kRemembers     keeps in the FootContact how deep it was pressed, memory_depth,
//   kDrawnAsSand   pages draw sand, else something solid.
// To add a law: its file, and its name in GroundKind and Laws (ground.h).
#pragma once

#include "sim/ground/foot_profile.h"
#include "sim/lanes/lanes.h"

namespace sandrunner::sim {

/// Place and motion of a foot's deepest point. x, y: along the ground (Shape), on level ground in
/// the world, m; z: its depth below the surface, along the normal, m; v = dz/dt and vx, vy in m/s;
/// pressed: how deep that surface has been pressed below the undisturbed one before, m; tilt_x,
/// tilt_y: slope of a flat sole over the ground, which rises along x and y; of other feet 0.
template <typename S>
struct FootMotion {
  S x{}, y{}, z{}, v{}, vx{}, vy{}, pressed{}, tilt_x{}, tilt_y{};
};

/// What a foot's contact remembers, in the words of the granular law; mud.h says what it keeps in
/// which. What a law reads is reset when the foot touches down, but for the first three.
template <typename S>
struct FootContact {
  S active{};                ///< 1 from touchdown to lift-off
  S region{};                ///< index of the patch of ground it touched down on
  S velocity{};              ///< v of the previous step, also in the air, m/s
  S memory_depth{};          ///< deepest penetration so far, less what has healed, m
  S memory_x{}, memory_y{};  ///< where that was, as in FootMotion, m
  S memory_travel{};         ///< greatest distance along the ground from there since, m
  S restart_flat{};          ///< I_flat at which the present cone began to grow, m^3
  S filter{};                ///< tau_r of eq. S16
  S force{};                 ///< filtered normal force, N
  S stroke_latched{};        ///< 1: the foot ploughs beyond its crater
  S stroke_x{}, stroke_y{}, stroke_depth{};  ///< crater's centre and depth as latched, m
  S stroke_travel{};                         ///< greatest distance from that centre since, m
};

template <typename S>
inline FootContact<S> select(const Mask<S>& m, const FootContact<S>& a,
                             const FootContact<S>& b) noexcept {
  FootContact<S> chosen = b;
  assign_where<S>(m, a, chosen);
  return chosen;
}

/// Forces of the ground on a foot at one step.
template <typename S>
struct FootForce {
  S normal{};          ///< N; < 0: holds the foot back
  S raw{};             ///< normal before the filter of the granular law, N
  S friction_bound{};  ///< of the tangential force, N
  S stroke{};          ///< resistance along the ground, N, acts along -(direction_x, direction_y)
  S direction_x{}, direction_y{};  ///< unit vector, axes of FootMotion
  // Feet that share a pressure: the force without it before it is cut at zero, N, and the square
  // root of the pressure's stiffness; 0: none.
  S uncut{}, coupling{};
};
/// That of a patch of a foot, from the force on the whole of it.
template <typename S>
inline FootForce<S> share_of(FootForce<S> f, S share) noexcept {
  for (S* part : {&f.normal, &f.raw, &f.friction_bound, &f.stroke, &f.uncut, &f.coupling}) {
    *part = share * *part;
  }
  return f;
}
template <typename S>
inline FootForce<S> select(const Mask<S>& m, const FootForce<S>& a,
                           const FootForce<S>& b) noexcept {
  return {select(m, a.normal, b.normal),
          select(m, a.raw, b.raw),
          select(m, a.friction_bound, b.friction_bound),
          select(m, a.stroke, b.stroke),
          select(m, a.direction_x, b.direction_x),
          select(m, a.direction_y, b.direction_y),
          select(m, a.uncut, b.uncut),
          select(m, a.coupling, b.coupling)};
}

}  // namespace sandrunner::sim
