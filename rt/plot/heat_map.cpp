// SPDX-License-Identifier: BSD-3-Clause
#include "rt/plot/heat_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace sandrunner::plot {
namespace {

// Light yellow (0) over green to dark blue (1), ends after ColorBrewer's YlGnBu.
Color shade(double share) {
  constexpr Color kStops[] = {
      {1.00, 1.00, 0.85}, {0.78, 0.91, 0.71}, {0.25, 0.71, 0.77}, {0.13, 0.37, 0.66}};
  const double at = 3.0 * std::clamp(share, 0.0, 1.0);
  const auto i = std::min(static_cast<std::size_t>(at), std::size_t{2});
  const double t = at - static_cast<double>(i);
  const auto mix = [&](double a, double b) { return a + t * (b - a); };
  return {mix(kStops[i].red, kStops[i + 1].red), mix(kStops[i].green, kStops[i + 1].green),
          mix(kStops[i].blue, kStops[i + 1].blue)};
}

}  // namespace

void draw_map(const Canvas& canvas, const HeatMap& map, double left_px, double top_px) {
  const std::size_t columns = map.column_labels.size(), rows = map.row_labels.size();
  const double bottom_px = top_px + static_cast<double>(rows) * kMapCellHeight_px;
  const auto column_px = [&](double column) { return left_px + column * kMapCellWidth_px; };
  canvas.text(left_px, top_px - 10.0, map.title, 14.0, 0.0, kInk, true);
  for (std::size_t column = 0; column < columns; ++column) {
    for (std::size_t row = 0; row < rows; ++row) {
      const double value = map.values[column * rows + row];
      const double x = column_px(static_cast<double>(column));
      const double y = top_px + static_cast<double>(rows - 1 - row) * kMapCellHeight_px;
      double share = map.high > map.low ? (value - map.low) / (map.high - map.low) : 0.0;
      if (map.dark_is_low) share = 1.0 - share;
      canvas.set_color(std::isnan(value) ? Color{0.2, 0.2, 0.2} : shade(share));
      cairo_rectangle(canvas.cairo(), x, y, kMapCellWidth_px, kMapCellHeight_px);
      cairo_fill(canvas.cairo());
      if (std::isnan(value)) continue;
      const Color ink = share > 0.7 ? Color{1.0, 1.0, 1.0} : kInk;
      canvas.text(x + 0.5 * kMapCellWidth_px, y + 0.5 * kMapCellHeight_px + 4.0,
                  fmt::format("{:.{}f}", value, map.digits), 11.0, 0.5, ink);
    }
  }
  for (std::size_t i = 0; i < columns; ++i) {
    canvas.text(column_px(static_cast<double>(i) + 0.5), bottom_px + 15.0, map.column_labels[i],
                11.0, 0.5, kFaintInk);
  }
  for (std::size_t i = 0; i < rows; ++i) {
    canvas.text(left_px - 6.0, bottom_px - (static_cast<double>(i) + 0.5) * kMapCellHeight_px + 4.0,
                map.row_labels[i], 11.0, 1.0, kFaintInk);
  }
  canvas.text(column_px(0.5 * static_cast<double>(columns)), bottom_px + 32.0, map.caption, 11.0,
              0.5, kFaintInk);
}

}  // namespace sandrunner::plot
