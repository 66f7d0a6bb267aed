// SPDX-License-Identifier: BSD-3-Clause
// Is the ground right? The contact law of sim/ground against experiments that others published.
// Parameters come from the materials' published constants; the one that is fitted is fitted on one
// number, and what is compared with is none of it.
#pragma once

#include <string>
#include <vector>

#include "sim/ground/ground.h"

namespace sandrunner::study {

struct Anchor {
  std::string experiment, source, quantity;
  double published = 0.0, ours = 0.0;
  int digits = 2;

  double deviation() const { return ours / published - 1.0; }
};

/// All rows of the chapter's table.
std::vector<Anchor> ground_anchors();

/// How deep a dropped ball goes and how long that takes.
struct Stop {
  double depth_m = 0.0, time_s = 0.0;
};

inline constexpr double kFootRadius_m = 0.0295;  // of the paper's robot

struct Ball {
  double diameter_m = 0.0254, mass_kg = 0.0692;
};

/// Glass beads of Katsuragi & Durian 2007: bulk density 1,520 kg/m^3, packing 0.59. Their k/m of
/// 1,040 /s^2 for the ball of 25.4 mm sets the stress per depth, the same on flat and cone; all
/// else is the sand of the paper authors' code.
sim::GroundParameters glass_beads();
/// Our law: a ball that hits the ground at this speed, until it first comes to rest.
Stop drop_ball(const Ball& ball, const sim::GroundParameters& ground, double impact_mps);
/// Their law for their ball, m a = -m g + k z + m v^2/d1 with d1 = 87 mm, integrated.
Stop katsuragi_durian(double impact_mps);

/// Mean vertical stress on a disc, of the foot's radius, over depth, pushed down slowly, N/m^3.
double disc_stress_per_depth(const sim::GroundParameters& ground, double depth_m,
                             double radius_m = kFootRadius_m);
/// The same, of the last bit of depth.
double disc_stress_gradient(const sim::GroundParameters& ground, double depth_m);

/// Horizontal force on the robot's foot that is dragged at this depth and speed, N: friction and
/// stroke resistance 30 mm outside of its crater.
double drag_force(const sim::GroundParameters& ground, double depth_m, double speed_mps);

}  // namespace sandrunner::study
