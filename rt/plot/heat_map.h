// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "rt/plot/plot.h"

namespace sandrunner::plot {

inline constexpr double kMapCellWidth_px = 47.0, kMapCellHeight_px = 26.0;

/// A table of numbers as coloured cells with their values: light yellow at one end, dark blue at
/// the other, dark grey where the value is not a number.
struct HeatMap {
  std::string title;
  std::vector<double> values;  ///< column by column, each from the bottom up
  std::vector<std::string> column_labels, row_labels;
  std::string caption;           ///< what lies across and up
  double low = 0.0, high = 1.0;  ///< ends of the colours, so that maps can share a scale
  int digits = 1;
  bool dark_is_low = false;
};

/// Draws the map with the upper left corner of its cells at (left, top).
void draw_map(const Canvas& canvas, const HeatMap& map, double left_px, double top_px);

}  // namespace sandrunner::plot
