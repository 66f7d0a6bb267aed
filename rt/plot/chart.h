// SPDX-License-Identifier: BSD-3-Clause
// Charts side by side in one PNG: each with an x axis of its own and with dots, lines, caps, bars
// and bands.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "rt/plot/plot.h"

namespace sandrunner::plot {

inline constexpr double kAutomatic = std::numeric_limits<double>::quiet_NaN();

/// How a thing looks in every figure.
struct Style {
  Color color;
  std::vector<double> dashes_px = {};  ///< lengths of strokes and gaps; empty: a solid line
};

/// Points (x, y); one with a value that is not finite is a gap. `low` and `high`, if not empty, are
/// as long as `x`.
struct ChartSeries {
  std::string name;  ///< in the legend of the page; empty: not there
  Style style;
  std::vector<double> x, y;
  std::vector<double> low = {}, high = {};  ///< drawn as caps, or with `band` as a shaded range
  bool line = true;
  bool dots = false;
  bool bars = false;  ///< from 0 to y, next to those of other series at the same x
  bool band = false;
};

struct Chart {
  std::string title;
  std::string x_label, y_label;
  std::vector<ChartSeries> series;
  /// Ends of the axes; kAutomatic: from the values.
  double x_begin = kAutomatic, x_end = kAutomatic;
  double y_begin = kAutomatic, y_end = kAutomatic;
  /// Names of x = 0, 1, 2, ... in place of numbers.
  std::vector<std::string> categories = {};
  std::string note = {};  ///< written in the middle of a chart without values
};

/// Charts in rows, with one legend above all: series of the same name must look the same.
struct ChartPage {
  std::string title;
  std::vector<Chart> charts;
  int columns = 2;
  int width_px = 1240;
  int chart_height_px = 330;
};

/// Draws the page; InputError if the file cannot be written.
void draw_charts(const ChartPage& page, const std::string& png_path);

}  // namespace sandrunner::plot
