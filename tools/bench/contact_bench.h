// SPDX-License-Identifier: BSD-3-Clause
// The cone model of sim/ground/granular.h against dynamic resistive force theory on the same drops
// (paper, section S13 and fig. S12: cylinders dropped on ground with random parameters).
#pragma once

#include <cstdint>

#include "sim/ground/ground.h"
#include "tools/bench/drft.h"
#include "tools/bench/report.h"

namespace sandrunner::bench {

// The cylinder is the robot's foot: a tyre that lies along y.
inline constexpr double kFootRadius_m = 0.0295, kFootWidth_m = 0.025;
inline constexpr double kDropStep_s = 0.25e-3;
/// 0.5 s from just above the ground: longer than any of the drops takes to come to rest.
inline constexpr int kDropSteps = 2000;

/// One drop: a point mass on an upright foot that hits the ground straight down.
struct Drop {
  double mass_kg, impact_speed_mps;
  double x_m, y_m;                         ///< where; flat ground, so that it changes nothing
  sim::Vec3<double> slip_mps, spin_radps;  ///< sideways motion and turning of the foot: none
  sim::Ground<double> ground;
  DrftMedium medium;
};

/// Penetration of the deepest point when the drop is over, and 0.1 s before.
struct Depths {
  double final_m, before_m;
};

sim::FootProfile<double> foot_profile();
/// The foot's surface for PlanarDrft (the rim alone: the ends have no part in motion in its plane)
/// and for SpatialDrft: 400 elements each.
PlanarDrft planar_foot();
SpatialDrft spatial_foot();

/// Drop number `index` of those that are timed. All draws uniform: mass 2.5 to 10 kg, fall of 0.02
/// to 0.25 m, sigma_flat 1 to 10 and sigma_cone 0.15 to 0.6 MN/m^3 (the paper's grid), grain
/// density 800 to 2700 kg/m^3, packing 0.55 to 0.63, nu 1.5 to 2.5, theta 55 to 66 deg, c_g 1.5 to
/// 3.5, c_d 3 to 20 but c_d c_g phi rho nu at most 6e4 kg/m^3. The same ground for DRFT: zeta =
/// sigma_cone / cos(theta), the stress gradient of the full cone over the area it stands on, and
/// the bulk density phi rho.
Drop random_drop(std::uint64_t index, const sim::FootProfile<double>& foot);

/// Semi-implicit Euler for kDropSteps, the force of the cone model as in the robot's step.
Depths drop_on_cone(const sim::FootProfile<double>& foot, const Drop& drop) noexcept;
/// The same with DRFT. Its force opposes motion however slow, like friction; so it is taken at the
/// velocity the step would end with otherwise, and may stop the foot but not turn it round.
template <typename Drft>
Depths drop_on_drft(const Drft& foot, const Drop& drop) noexcept;
extern template Depths drop_on_drft(const PlanarDrft&, const Drop&) noexcept;
extern template Depths drop_on_drft(const SpatialDrft&, const Drop&) noexcept;

/// Times `drops` drops on each model, alternately, `rounds` times. Throws std::runtime_error if one
/// has not come to rest: the depths would mean nothing.
Report run_contact_bench(int rounds, int drops = 1000);

}  // namespace sandrunner::bench
