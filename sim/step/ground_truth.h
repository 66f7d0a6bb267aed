// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>

#include "rt/core/messages.h"
#include "sim/step/robot_step.h"

namespace sandrunner::sim {

/// What the policy's network estimates, as it is: the truth of training, simulator and evaluation.
/// Velocity of the base origin in the body frame, m/s; heights along the vertical, m. The
/// undisturbed ground is the plane through the surface under the base origin, as steep as the
/// ground without its waves is there; the deformed ground lies below it by the deepest penetration
/// of the feet in contact (yielded_depth()), from the bottom
/// of a print that they step into. `model`: of the nominal robot, whose legs give the
/// feet. S: float or double.
template <typename S>
StateEstimate ground_truth(const RobotModel<double>& model, const RobotState<S>& state,
                           const Terrain<S>& terrain, const Relief<S>& relief = {}) noexcept {
  const RigidState<S>& x = state.rigid;
  const Mat3<S> r = rotation_matrix(x.orientation);
  const Vec3<S> v = transposed_times(r, x.velocity);
  Shape<S> shape = terrain.shape;
  const S surface = surface_at(shape, relief, x.position.x, x.position.y).height;
  shape.roughness = S(0.0);
  const Surface<S> plane = surface_at(shape, relief, x.position.x, x.position.y);
  const S stretch =
      sqrt(fma(plane.slope_x, plane.slope_x, fma(plane.slope_y, plane.slope_y, S(1.0))));
  const Vec3<S> up = mul_add(r.r0, -plane.slope_x, mul_add(r.r1, -plane.slope_y, r.r2));
  S deepest = S(0.0);
  StateEstimate truth;
  truth.velocity_mps = {v.x, v.y, v.z};
  for (int l = 0; l < kNumLegs; ++l) {
    const LegModel<double>& leg = model.legs[l];
    const LegPose<double> p =
        leg_pose(leg, double(x.q[3 * l]), double(x.q[3 * l + 1]), double(x.q[3 * l + 2]));
    const Vec3<double> foot = hip_to_base(leg, p, p.foot);
    truth.foot_height_m[l] =
        x.position.z - surface + static_cast<S>(up.x * foot.x + up.y * foot.y + up.z * foot.z);
    const double depth = model.foot_radius_m - truth.foot_height_m[l] / stretch;
    for (int patch = 0; patch < kMaxFootPatches; ++patch) {
      const FootContact<S>& contact = state.contact(l, patch);
      const Ground<S>& ground = terrain.ground[static_cast<std::size_t>(contact.region)];
      if (!(contact.active > S(0.0)) || ground.hard > S(0.0)) continue;
      deepest = std::max(deepest, yielded_depth(ground, contact, static_cast<S>(depth)));
    }
  }
  truth.body_height_m = x.position.z - surface + deepest * stretch;
  return truth;
}

}  // namespace sandrunner::sim
