// SPDX-License-Identifier: BSD-3-Clause
// One patch of ground: its kind, the parameters of all laws of force as a person writes them (SI
// units), and the constants that the step uses.
#pragma once

#include <cstdint>

#include "sim/ground/granular.h"
#include "sim/ground/linear.h"
#include "sim/ground/mud.h"
#include "sim/ground/rigid.h"

namespace sandrunner::sim {

template <template <typename> typename... Law>
struct LawList {
  static constexpr const char* kNames[] = {Law<double>::Parameters::kName...};
  static constexpr bool kHard[] = {Law<double>::kHard...};
  static constexpr bool kDrawnAsSand[] = {Law<double>::kDrawnAsSand...};

  struct Parameters : Law<double>::Parameters... {};
  template <typename S>
  struct Constants : Law<S>... {};

  /// Calls `visit.operator()<Law>(index)` for each law.
  template <typename Visit>
  static void for_each(const Visit& visit) {
    int index = 0;
    (visit.template operator()<Law>(index++), ...);
  }
};

/// All laws, in the order of GroundKind.
using Laws = LawList<GranularLaw, RigidLaw, LinearLaw, MudLaw>;
enum class GroundKind : std::uint32_t { kGranular, kRigid, kLinear, kMud };

/// Its word in `terrain.kind`.
constexpr const char* kind_name(GroundKind kind) noexcept {
  return Laws::kNames[static_cast<int>(kind)];
}

/// Parameters of a patch of ground. Those of other kinds than its own are kept, too.
struct GroundParameters : Laws::Parameters {
  GroundKind kind = GroundKind::kGranular;
  double friction = 0.8;    ///< Coulomb coefficient foot-ground
  bool footprints = false;  ///< what a foot pressed stays pressed (footprints.h); of soil and mud
  double repose_rad = 0.5934119456780721;  ///< steepest slope that footprints leave

  bool is_hard() const noexcept { return Laws::kHard[static_cast<int>(kind)]; }
  /// Whether a robot stands on it as deep as on `other`, or nearly so.
  bool carries_like(const GroundParameters& other) const noexcept;
};

/// Constants of one patch, derived once from GroundParameters, whose symbols and units they keep.
/// S: one robot, or a value per lane.
template <typename S>
struct Ground : Laws::Constants<S> {
  S kind{};  ///< a GroundKind
  S hard{};  ///< 1: impenetrable
  S friction{};
  S footprints{};  ///< 1: it keeps them
  S repose{};      ///< tangent of their steepest slope
};

/// Derives the constants for a foot. `foot_radius_m` is the r_f of the HSR model.
Ground<double> derive_ground(const GroundParameters& parameters, const FootProfile<double>& foot,
                             double foot_radius_m);

/// One step of the ground's law at a foot; `rate_hz`: steps per second. Lanes on hard ground, and
/// those in which the foot is in the air, come out zero; `contact` is updated.
template <typename S>
inline FootForce<S> foot_force(const Ground<S>& ground, const FootProfile<S>& foot,
                               const FootMotion<S>& motion, S rate_hz,
                               FootContact<S>& contact) noexcept {
  // The first law steps on every ground and in the air: it tells where contacts begin and end. What
  // it remembers gives way to what another law does where that is the ground.
  const FootContact<S> before = contact;
  FootForce<S> force;
  Laws::for_each([&]<template <typename> typename Law>(int index) {
    if constexpr (!Law<S>::kHard) {
      const Law<S>& law = ground;
      const Mask<S> here = ground.kind == S(double(index));
      if (index > 0 && !any(here)) return;
      const bool keeps_own = index > 0 && Law<S>::kRemembers;
      FootContact<S> own = before;
      force = select(
          here, law.step(foot, ground.friction, motion, rate_hz, keeps_own ? own : contact), force);
      if (keeps_own) contact = select(here, own, contact);
    }
  });
  return force;
}

/// How deep the ground under a foot in contact has yielded along its normal, m: as deep as the law
/// remembers, or else as the foot is. S: float or double.
template <typename S>
S yielded_depth(const Ground<S>& ground, const FootContact<S>& contact, S foot_depth) noexcept {
  S depth = foot_depth;
  Laws::for_each([&]<template <typename> typename Law>(int index) {
    if (Law<S>::kRemembers && ground.kind == S(index)) depth = contact.memory_depth;
  });
  return depth;
}

}  // namespace sandrunner::sim
