// SPDX-License-Identifier: BSD-3-Clause
// E7: what results.json holds of a network on the grid, and the figures that are made of it.
//   kGridCells: lists, a value for each cell: sigma_flat_npm3, sigma_cone_npm3, static_depth_m,
//     success, reward, clearance_m (nan where the success is not above kLeastSuccess)
//   kGridRobots: a run is a robot, which has the same start and command in each cell: reward and
//     success, means over the cells; slope_flat_m, slope_cone_m, of its clearance
#pragma once

#include <vector>

#include "tools/study/evidence/evidence.h"

namespace sandrunner::study {

inline constexpr const char* kGridGround = "grid";
inline constexpr const char* kGridCells = "cells";
inline constexpr const char* kGridRobots = "robots";
/// The paper's criterion: a cell with no more success than this is black.
inline constexpr double kLeastSuccess = 0.10;

/// The controllers of Fig. 4 A to D, table S1 and fig. S10.
const std::vector<const char*>& grid_controllers();

/// y = constant + a_slope a + b_slope b, by least squares over the points whose y is not nan.
struct Slopes {
  double a = 0.0, b = 0.0;  ///< nan if the points don't tell them
};
Slopes fit_slopes(const std::vector<double>& a, const std::vector<double>& b,
                  const std::vector<double>& y);

/// A list of kGridCells of one measurement.
const std::vector<double>& grid_list(const Measured& measured, const char* name);
/// Each cell's median over the seeds that have a value there; empty: not run.
std::vector<double> grid_medians(const Evidence& evidence, const char* controller,
                                 const char* name);
/// A figure of kGridRobots: the mean over the robots, with each robot's value.
Figure grid_figure(const Evidence& evidence, const char* controller, const char* name);
/// Mean of a list over the softest and the stiffest quarter of the cells, by static depth.
struct SoftAndStiff {
  double soft = 0.0, stiff = 0.0;
};
SoftAndStiff soft_and_stiff(const Measured& measured, const char* name);

}  // namespace sandrunner::study
