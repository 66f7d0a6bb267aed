// SPDX-License-Identifier: BSD-3-Clause
// What the painters of this folder share: a box on the canvas with a range of values each way, its
// ticks and its grid.
#pragma once

#include <vector>

#include "rt/plot/plot.h"

namespace sandrunner::plot {

struct Range {
  double begin = 0.0, end = 1.0;
};

/// Pixels.
struct Box {
  double left = 0.0, top = 0.0, width = 0.0, height = 0.0;

  double right() const { return left + width; }
  double bottom() const { return top + height; }
};

inline constexpr double kPixelsPerXTick = 90.0;
inline constexpr double kPixelsPerYTick = 26.0;

/// The middle of a pixel, where thin lines are sharp.
double crisp(double px);

/// Where a value lies between two places.
double map(double value, const Range& range, double at_begin, double at_end);

struct Ticks {
  std::vector<double> values;
  double step = 1.0;
};

Ticks ticks_for(const Range& range, double length_px, double pixels_per_tick);

/// Grid and outline of a box.
void draw_frame(const Canvas& canvas, const Range& x_range, const Range& y_range, const Box& box);

}  // namespace sandrunner::plot
