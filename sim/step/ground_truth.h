// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>

#include "rt/core/messages.h"
#include "sim/step/robot_step.h"

namespace sandrunner::sim {

/// What the policy's network estimates, as it is: the truth of training, simulator and evaluation.
/// Velocity of the base origin in the body frame, m/s; heights in m. The undisturbed ground is the
/// surface under the base origin; the deformed ground lies below it by the deepest penetration of
/// the feet in contact: on granular ground the one that they remember, on springs the present one.
/// `model`: of the nominal robot, whose legs give the feet. S: float or double.
template <typename S>
StateEstimate ground_truth(const RobotModel<double>& model, const RobotState<S>& state,
                           const Terrain<S>& terrain) noexcept {
  const RigidState<S>& x = state.rigid;
  const Mat3<S> r = rotation_matrix(x.orientation);
  const Vec3<S> v = transposed_times(r, x.velocity);
  const S surface = surface_at(terrain, x.position.x, x.position.y).height;
  S deepest = S(0.0);
  StateEstimate truth;
  truth.velocity_mps = {v.x, v.y, v.z};
  for (int l = 0; l < kNumLegs; ++l) {
    const LegModel<double>& leg = model.legs[l];
    const LegPose<double> p =
        leg_pose(leg, double(x.q[3 * l]), double(x.q[3 * l + 1]), double(x.q[3 * l + 2]));
    const Vec3<double> foot = hip_to_base(leg, p, p.foot);
    truth.foot_height_m[l] = x.position.z - surface +
                             static_cast<S>(r.r2.x * foot.x + r.r2.y * foot.y + r.r2.z * foot.z);
    const FootContact<S>& contact = state.feet[l];
    if (!(contact.active > S(0.0))) continue;
    const Ground<S>& ground = terrain.ground[static_cast<std::size_t>(contact.region)];
    if (ground.is_granular > S(0.0)) deepest = std::max(deepest, contact.memory_depth);
    if (ground.is_linear > S(0.0)) {
      deepest = std::max(deepest, static_cast<S>(model.foot_radius_m - truth.foot_height_m[l]));
    }
  }
  truth.body_height_m = x.position.z - surface + deepest;
  return truth;
}

}  // namespace sandrunner::sim
