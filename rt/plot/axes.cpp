// SPDX-License-Identifier: BSD-3-Clause
#include "rt/plot/axes.h"

#include <algorithm>
#include <cmath>

namespace sandrunner::plot {
namespace {

constexpr Color kGrid{0.89, 0.90, 0.92};
constexpr Color kAxis{0.62, 0.65, 0.69};

}  // namespace

double crisp(double px) { return std::floor(px) + 0.5; }

double map(double value, const Range& range, double at_begin, double at_end) {
  return at_begin + (value - range.begin) / (range.end - range.begin) * (at_end - at_begin);
}

Ticks ticks_for(const Range& range, double length_px, double pixels_per_tick) {
  Ticks result;
  result.values =
      ticks(range.begin, range.end, std::max(2, static_cast<int>(length_px / pixels_per_tick)));
  if (result.values.size() > 1) result.step = result.values[1] - result.values[0];
  return result;
}

void draw_frame(const Canvas& canvas, const Range& x_range, const Range& y_range, const Box& box) {
  cairo_t* cr = canvas.cairo();
  cairo_set_line_width(cr, 1.0);
  canvas.set_color(kGrid);
  for (const double x : ticks_for(x_range, box.width, kPixelsPerXTick).values) {
    const double x_px = crisp(map(x, x_range, box.left, box.right()));
    cairo_move_to(cr, x_px, box.top);
    cairo_line_to(cr, x_px, box.bottom());
  }
  for (const double y : ticks_for(y_range, box.height, kPixelsPerYTick).values) {
    const double y_px = crisp(map(y, y_range, box.bottom(), box.top));
    cairo_move_to(cr, box.left, y_px);
    cairo_line_to(cr, box.right(), y_px);
  }
  cairo_stroke(cr);
  canvas.set_color(kAxis);
  if (y_range.begin < 0.0 && y_range.end > 0.0) {
    const double zero_px = crisp(map(0.0, y_range, box.bottom(), box.top));
    cairo_move_to(cr, box.left, zero_px);
    cairo_line_to(cr, box.right(), zero_px);
  }
  cairo_rectangle(cr, crisp(box.left), crisp(box.top), std::floor(box.width),
                  std::floor(box.height));
  cairo_stroke(cr);
}

}  // namespace sandrunner::plot
