// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <limits>

#include "sim/robot/dynamics.h"

namespace sandrunner::sim {

/// Least height above the ground, m, of feet, knees and lower corners of the base, for a level base
/// with its origin at z = 0 and joints at `q_rad`; negative: below the ground. The ground's height
/// at x, y of the base frame is `surface_height(x, y)`.
template <typename SurfaceHeight>
double lowest_clearance(const RobotModel<double>& model, const JointArray<double>& q_rad,
                        const SurfaceHeight& surface_height) {
  double lowest = std::numeric_limits<double>::infinity();
  for (int l = 0; l < kNumLegs; ++l) {
    const LegModel<double>& leg = model.legs[l];
    const LegPose<double> p = leg_pose(leg, q_rad[3 * l], q_rad[3 * l + 1], q_rad[3 * l + 2]);
    for (int patch = 0; patch < static_cast<int>(model.foot_patches); ++patch) {
      const Vec3<double> foot = hip_to_base(leg, p, patch_centre(leg, p, patch));
      lowest = std::min(lowest, foot.z - model.foot_radius_m - surface_height(foot.x, foot.y));
    }
    const Vec3<double> knee = hip_to_base(leg, p, p.knee);
    lowest = std::min(lowest, knee.z - model.knee_radius_m - surface_height(knee.x, knee.y));
  }
  const Vec3<double>&centre = model.base_box_centre_m, &half = model.base_box_half_m;
  for (const double side_x : {-1.0, 1.0}) {
    for (const double side_y : {-1.0, 1.0}) {
      lowest = std::min(lowest,
                        centre.z - half.z -
                            surface_height(centre.x + side_x * half.x, centre.y + side_y * half.y));
    }
  }
  return lowest;
}

}  // namespace sandrunner::sim
