// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rt/plot/plot.h"
#include "rt/report/run_record.h"

namespace sandrunner {

inline constexpr double kSideViewWidth_px = 350.0;
inline constexpr double kSideViewHeight_px = 258.0;

/// Draws the robot as it was in a row of the record, from its right side: ground, footprints so
/// far, robot. The base stays in the middle; a ruler in the ground tells that it has walked
/// `distance_m`.
void draw_side_view(const plot::Canvas& canvas, const RunRecord& record, const RunRow& row,
                    double distance_m, double left_px, double top_px);

}  // namespace sandrunner
