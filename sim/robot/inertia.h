// SPDX-License-Identifier: BSD-3-Clause
// Masses and inertias that a rigid body can have.
#pragma once

#include "sim/lanes/vec.h"

namespace sandrunner::sim {

/// A link that moves by itself and weighs less is a slip (g for kg), and one that the simulator's
/// step cannot resolve.
inline constexpr double kLeastMass_kg = 1e-3;

/// Above 0 in every direction.
inline bool is_positive_definite(const Sym3<double>& m) noexcept {
  const double d2 = m.xx * m.yy - m.xy * m.xy;
  const double d3 = m.xx * (m.yy * m.zz - m.yz * m.yz) - m.xy * (m.xy * m.zz - m.yz * m.xz) +
                    m.xz * (m.xy * m.yz - m.yy * m.xz);
  return m.xx > 0.0 && d2 > 0.0 && d3 > 0.0;
}

/// Whether `m`, kg m^2 about the centre of mass, can be a body's. The moment about an axis is the
/// mass's spread along the two others: an inertia J belongs to a body if its spread, trace(J)/2 -
/// J, is not negative in any direction. A plate has none across; published figures may be
/// up to a fiftieth of the trace below (those of Mini Cheetah's thigh are a hundredth).
inline bool is_inertia_of_a_body(const Sym3<double>& m) noexcept {
  const double trace = m.xx + m.yy + m.zz;
  const double half = (0.5 + 0.02) * trace;
  return is_positive_definite(m) &&
         is_positive_definite({half - m.xx, -m.xy, -m.xz, half - m.yy, -m.yz, half - m.zz});
}

}  // namespace sandrunner::sim
