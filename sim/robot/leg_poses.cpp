// SPDX-License-Identifier: BSD-3-Clause
#include "sim/robot/leg_poses.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace sandrunner::sim {
namespace {

using Vec = Vec3<double>;
/// Kept from a stop, and from a leg that is folded flat.
constexpr double kMargin_rad = 0.05, kMostBend_rad = 2.65;
constexpr double kMostApart_rad = 0.8;

/// How far a vector is turned about y from straight down.
double angle_of(const Vec& v) { return std::atan2(-v.x, -v.z); }

double length_of(const Vec& v) { return std::hypot(v.x, v.z); }

/// The joint's angle for a turn about y, between its stops; nothing if they leave none.
std::optional<double> within_stops(const LegGeometry& leg, int j, double turn_rad) {
  const double q = leg.sign[j] * turn_rad;
  std::optional<double> best;
  for (const double turned : {q - 2.0 * std::numbers::pi, q, q + 2.0 * std::numbers::pi}) {
    const bool inside =
        turned >= leg.lower_rad[j] + kMargin_rad && turned <= leg.upper_rad[j] - kMargin_rad;
    if (inside && (!best || std::fabs(turned) < std::fabs(*best))) best = turned;
  }
  return best;
}

/// How far the foot's direction from the hip is turned from the thigh's.
double thigh_to_foot(const LegGeometry& leg, double bend_rad) {
  const double shank = length_of(leg.foot);
  return std::atan2(shank * std::sin(bend_rad), length_of(leg.kfe) + shank * std::cos(bend_rad));
}

/// The pose with the knee bent by `bend_rad` and the foot in direction `foot_rad` from the hip,
/// both turns about y; HAA at 0, or at the stop next to it.
std::optional<LegJoints<double>> bent(const LegGeometry& leg, double bend_rad, double foot_rad) {
  const double straight = angle_of(leg.foot) - angle_of(leg.kfe);
  const auto kfe = within_stops(leg, 2, bend_rad - straight);
  const auto hfe =
      within_stops(leg, 1, foot_rad - thigh_to_foot(leg, bend_rad) - angle_of(leg.kfe));
  if (!kfe || !hfe) return std::nullopt;
  return LegJoints<double>{std::clamp(0.0, leg.lower_rad[0], leg.upper_rad[0]), *hfe, *kfe};
}

double reach_of(const LegGeometry& leg, double bend_rad) {
  const double thigh = length_of(leg.kfe), shank = length_of(leg.foot);
  return std::sqrt(thigh * thigh + shank * shank + 2.0 * thigh * shank * std::cos(bend_rad));
}

/// Whether all stops allow this bend with the foot straight below.
bool all_bend(const std::array<LegGeometry, kNumLegs>& legs, double bend_rad) {
  return std::ranges::all_of(
      legs, [&](const LegGeometry& leg) { return bent(leg, bend_rad, 0.0).has_value(); });
}

/// The first of the bends that all stops allow with the foot straight below; knees behind the hips
/// if they can. NaN: none.
double first_bend(const std::array<LegGeometry, kNumLegs>& legs,
                  std::initializer_list<double> bends) {
  for (const double side : {-1.0, 1.0}) {
    for (const double bend : bends) {
      if (all_bend(legs, side * bend)) return side * bend;
    }
  }
  return std::nan("");
}

/// One pose for all legs, the mean of theirs: they may differ by how the zeros of front and hind
/// legs lie, not by where they bend.
LegJoints<double> mean_fold(const UrdfReader& urdf, const std::array<LegGeometry, kNumLegs>& legs,
                            double bend_rad) {
  LegJoints<double> mean{};
  const LegJoints<double> first = *bent(legs[0], bend_rad, 0.0);
  for (int j = 0; j < kJointsPerLeg; ++j) {
    double lower = -10.0, upper = 10.0;
    for (const LegGeometry& leg : legs) {
      const double folded = (*bent(leg, bend_rad, 0.0))[j];
      if (std::fabs(folded - first[j]) > kMostApart_rad) {
        urdf.fail(
            fmt::format("folded, joint {} of the legs is at {:.3g} and at {:.3g} rad: found "
                        "axes or zeros that differ from leg to leg, expected the same",
                        j + 1, first[j], folded));
      }
      mean[j] += folded / kNumLegs;
      lower = std::max(lower, leg.lower_rad[j]);
      upper = std::min(upper, leg.upper_rad[j]);
    }
    if (lower > upper) {
      urdf.fail(fmt::format("joint {} of the legs has no angle between all of their stops", j + 1));
    }
    mean[j] = std::clamp(mean[j], lower, upper);
  }
  return mean;
}

/// On its belly: the foot at the height of the ground, behind or before the hip, or in the air.
LegJoints<double> lying(const LegGeometry& leg, double bend_rad, double drop_m,
                        const LegJoints<double>& fold) {
  const double reach = reach_of(leg, bend_rad);
  if (drop_m < reach) {
    const double aside = std::acos(std::max(drop_m / reach, -1.0));
    // First the way that lifts the knee.
    for (const double side : {-std::copysign(1.0, bend_rad), std::copysign(1.0, bend_rad)}) {
      if (const auto pose = bent(leg, bend_rad, side * aside)) return *pose;
    }
  }
  return fold;
}

}  // namespace

LegPoses leg_poses(const UrdfReader& urdf, const std::array<LegGeometry, kNumLegs>& legs,
                   double belly_m, double foot_radius_m) {
  LegPoses poses;
  const double nominal = first_bend(legs, {1.5, 1.4, 1.6, 1.3, 1.2, 1.1, 1.0, 0.8});
  if (std::isnan(nominal)) {
    urdf.fail(
        "the stops of HFE and KFE leave no pose with bent knees and feet under the hips, the "
        "same for all legs");
  }
  double fold = nominal;
  for (double more = 0.05; std::fabs(nominal) + more <= kMostBend_rad; more += 0.05) {
    const double bend = std::copysign(std::fabs(nominal) + more, nominal);
    if (!all_bend(legs, bend)) break;
    fold = bend;
  }
  poses.fold_rad = mean_fold(urdf, legs, fold);
  for (int l = 0; l < kNumLegs; ++l) {
    const LegGeometry& leg = legs[l];
    const LegJoints<double> stands = *bent(leg, nominal, 0.0);
    const double hip_m = leg.haa.z + leg.hfe.z - belly_m;
    const LegJoints<double> lies = lying(leg, fold, hip_m - foot_radius_m, poses.fold_rad);
    std::copy_n(stands.begin(), kJointsPerLeg, &poses.nominal_rad[kJointsPerLeg * l]);
    std::copy_n(lies.begin(), kJointsPerLeg, &poses.lying_rad[kJointsPerLeg * l]);
  }
  poses.knee_lever_m =
      std::fabs(length_of(legs[0].kfe) * std::sin(thigh_to_foot(legs[0], nominal)));
  return poses;
}

}  // namespace sandrunner::sim
