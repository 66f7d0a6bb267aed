// SPDX-License-Identifier: BSD-3-Clause
// Poses of a leg of three joints from its geometry.
#pragma once

#include <array>

#include "rt/core/messages.h"
#include "sim/robot/urdf_reader.h"

namespace sandrunner::sim {

/// Where a joint that turns for ever may go: lower and upper, HAA, HFE, KFE.
inline constexpr double kFreeStops_rad[kJointsPerLeg][2] = {{-0.8, 0.8}, {-3.0, 3.0}, {-2.7, 2.7}};

/// A leg with all joints at zero, in base axes: each place from the one before, m.
struct LegGeometry {
  Vec3<double> haa{}, hfe{}, kfe{}, foot{};
  double foot_radius_m = 0.0;
  LegJoints<double> sign{1.0, 1.0, 1.0};  ///< of an axis along x, y, y
  LegJoints<double> lower_rad{}, upper_rad{};
};

struct LegPoses {
  JointArray<double> nominal_rad{}, lying_rad{};
  LegJoints<double> fold_rad{};
  double knee_lever_m = 0.0;  ///< from the foot to the knee, standing, along x
};

/// Standing: feet under the HFE axes. Folded: likewise, as far as the stops allow. Lying: folded,
/// with feet on the ground on which the base lies; `belly_m`: its lowest part, from its origin.
/// Throws InputError, which names `urdf`, if the stops leave no such pose.
LegPoses leg_poses(const UrdfReader& urdf, const std::array<LegGeometry, kNumLegs>& legs,
                   double belly_m, double foot_radius_m);

}  // namespace sandrunner::sim
