// SPDX-License-Identifier: BSD-3-Clause
#include "rt/plot/chart.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <set>

#include "rt/plot/axes.h"

namespace sandrunner::plot {
namespace {

constexpr double kLetters_px = 13.0;
constexpr double kMargin_px = 14.0;
constexpr double kYAxis_px = 72.0, kXAxis_px = 50.0, kChartHead_px = 30.0;
constexpr double kPageTitle_px = 40.0, kLegendRow_px = 24.0;
constexpr double kLegendSample_px = 34.0;  // of a line, in the legend
constexpr double kDotRadius_px = 3.6, kCap_px = 4.0;
constexpr double kCategoryBars = 0.8;  // share of the room between categories

struct Frame {
  Range x, y;
  Box box;

  double x_px(double value) const { return map(value, x, box.left, box.right()); }
  double y_px(double value) const { return map(value, y, box.bottom(), box.top); }
};

void stretch(Range& range, const std::vector<double>& values) {
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    range.begin = std::min(range.begin, v);
    range.end = std::max(range.end, v);
  }
}

// The range of an axis from its values, or from its ends where those are given.
Range axis_range(Range values, double begin, double end, double margin) {
  if (values.begin > values.end) values = {0.0, 1.0};
  const double size = std::max(values.end - values.begin, 1e-9 + 1e-3 * std::fabs(values.end));
  const Range wide{values.begin - margin * size, values.end + margin * size};
  Range range{std::isnan(begin) ? wide.begin : begin, std::isnan(end) ? wide.end : end};
  if (!(range.begin < range.end)) range.end = range.begin + 1.0;
  return range;
}

Frame frame_of(const Chart& chart, const Box& box) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Range x{kInfinity, -kInfinity}, y{kInfinity, -kInfinity};
  for (const ChartSeries& series : chart.series) {
    stretch(x, series.x);
    for (const auto* values : {&series.y, &series.low, &series.high}) stretch(y, *values);
    if (series.bars && !series.x.empty()) stretch(y, {0.0});
  }
  Frame frame{axis_range(x, chart.x_begin, chart.x_end, 0.03),
              axis_range(y, chart.y_begin, chart.y_end, 0.08), box};
  if (!chart.categories.empty()) {
    frame.x = {-0.5, static_cast<double>(chart.categories.size()) - 0.5};
  }
  return frame;
}

void set_line(const Canvas& canvas, const Style& style, double width_px) {
  cairo_t* cr = canvas.cairo();
  canvas.set_color(style.color);
  cairo_set_line_width(cr, width_px);
  cairo_set_dash(cr, style.dashes_px.data(), static_cast<int>(style.dashes_px.size()), 0.0);
}

void draw_line(const Canvas& canvas, const ChartSeries& series, const Frame& frame) {
  cairo_t* cr = canvas.cairo();
  bool pen_down = false;
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    const bool finite = std::isfinite(series.x[i]) && std::isfinite(series.y[i]);
    if (finite && pen_down) cairo_line_to(cr, frame.x_px(series.x[i]), frame.y_px(series.y[i]));
    if (finite && !pen_down) cairo_move_to(cr, frame.x_px(series.x[i]), frame.y_px(series.y[i]));
    pen_down = finite;
  }
  set_line(canvas, series.style, 2.2);
  cairo_stroke(cr);
  cairo_set_dash(cr, nullptr, 0, 0.0);
}

void draw_band(const Canvas& canvas, const ChartSeries& series, const Frame& frame) {
  cairo_t* cr = canvas.cairo();
  std::vector<std::size_t> shown;
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (std::isfinite(series.low[i]) && std::isfinite(series.high[i])) shown.push_back(i);
  }
  for (const std::size_t i : shown)
    cairo_line_to(cr, frame.x_px(series.x[i]), frame.y_px(series.low[i]));
  std::reverse(shown.begin(), shown.end());
  for (const std::size_t i : shown)
    cairo_line_to(cr, frame.x_px(series.x[i]), frame.y_px(series.high[i]));
  Color color = series.style.color;
  color.alpha = 0.18;
  canvas.set_color(color);
  cairo_fill(cr);
}

// Caps at x + `shift_px`: series that share an x stay apart.
void draw_caps(const Canvas& canvas, const ChartSeries& series, const Frame& frame,
               double shift_px) {
  cairo_t* cr = canvas.cairo();
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (!std::isfinite(series.low[i]) || !std::isfinite(series.high[i])) continue;
    const double x = frame.x_px(series.x[i]) + shift_px;
    const double low = frame.y_px(series.low[i]), high = frame.y_px(series.high[i]);
    cairo_move_to(cr, x, low);
    cairo_line_to(cr, x, high);
    for (const double y : {low, high}) {
      cairo_move_to(cr, x - kCap_px, y);
      cairo_line_to(cr, x + kCap_px, y);
    }
  }
  set_line(canvas, {series.bars ? kInk : series.style.color}, 1.3);
  cairo_stroke(cr);
}

void draw_dots(const Canvas& canvas, const ChartSeries& series, const Frame& frame) {
  cairo_t* cr = canvas.cairo();
  canvas.set_color(series.style.color);
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (!std::isfinite(series.x[i]) || !std::isfinite(series.y[i])) continue;
    cairo_new_sub_path(cr);
    cairo_arc(cr, frame.x_px(series.x[i]), frame.y_px(series.y[i]), kDotRadius_px, 0.0,
              2.0 * std::numbers::pi);
    cairo_fill(cr);
  }
}

// Room of one bar, and how many series have bars.
struct BarRoom {
  double width_px = 0.0;
  int count = 0;
};

BarRoom bar_room(const Chart& chart, const Frame& frame) {
  BarRoom room;
  std::set<double> places;
  for (const ChartSeries& series : chart.series) {
    room.count += series.bars;
    if (series.bars) places.insert(series.x.begin(), series.x.end());
  }
  double least = frame.x.end - frame.x.begin;
  for (auto at = places.begin(); at != places.end() && std::next(at) != places.end(); ++at) {
    least = std::min(least, *std::next(at) - *at);
  }
  if (!chart.categories.empty()) least = 1.0;
  const double between_px = least / (frame.x.end - frame.x.begin) * frame.box.width;
  if (room.count > 0) room.width_px = kCategoryBars * between_px / room.count;
  return room;
}

void draw_bars(const Canvas& canvas, const ChartSeries& series, const Frame& frame, double width_px,
               double shift_px) {
  cairo_t* cr = canvas.cairo();
  canvas.set_color(series.style.color);
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (!std::isfinite(series.y[i])) continue;
    const double top = frame.y_px(series.y[i]), zero = frame.y_px(0.0);
    cairo_rectangle(cr, frame.x_px(series.x[i]) + shift_px - 0.46 * width_px, std::min(top, zero),
                    0.92 * width_px, std::fabs(zero - top));
    cairo_fill(cr);
  }
}

void draw_axes(const Canvas& canvas, const Chart& chart, const Frame& frame) {
  const Box& box = frame.box;
  const Ticks y_ticks = ticks_for(frame.y, box.height, 1.5 * kPixelsPerYTick);
  for (const double y : y_ticks.values) {
    canvas.text(box.left - 7.0, frame.y_px(y) + 5.0, tick_label(y, y_ticks.step), kLetters_px, 1.0);
  }
  if (chart.categories.empty()) {
    const Ticks x_ticks = ticks_for(frame.x, box.width, 0.6 * kPixelsPerXTick);
    for (const double x : x_ticks.values) {
      canvas.text(frame.x_px(x), box.bottom() + 18.0, tick_label(x, x_ticks.step), kLetters_px,
                  0.5);
    }
  }
  for (std::size_t i = 0; i < chart.categories.size(); ++i) {
    canvas.text(frame.x_px(static_cast<double>(i)), box.bottom() + 18.0, chart.categories[i],
                kLetters_px, 0.5);
  }
  canvas.text(box.left + 0.5 * box.width, box.bottom() + 38.0, chart.x_label, kLetters_px, 0.5,
              kFaintInk);
  cairo_t* cr = canvas.cairo();
  cairo_save(cr);
  cairo_translate(cr, box.left - kYAxis_px + 18.0, box.top + 0.5 * box.height);
  cairo_rotate(cr, -0.5 * std::numbers::pi);
  canvas.text(0.0, 0.0, chart.y_label, kLetters_px, 0.5, kFaintInk);
  cairo_restore(cr);
}

void draw_chart(const Canvas& canvas, const Chart& chart, const Box& box) {
  const Frame frame = frame_of(chart, box);
  canvas.text(box.left, box.top - 9.0, chart.title, kLetters_px + 1.0, 0.0, kInk, true);
  draw_frame(canvas, chart.categories.empty() ? frame.x : Range{0.1, 0.2}, frame.y, box);
  draw_axes(canvas, chart, frame);
  cairo_t* cr = canvas.cairo();
  cairo_save(cr);
  cairo_rectangle(cr, box.left - 1.0, box.top - 1.0, box.width + 2.0, box.height + 2.0);
  cairo_clip(cr);
  const BarRoom room = bar_room(chart, frame);
  int bar = 0, capped = 0;
  bool empty = true;
  for (const ChartSeries& series : chart.series) {
    empty = empty && series.x.empty();
    const bool has_range = !series.low.empty();
    double shift_px = 0.0;
    if (series.bars) {
      shift_px = (bar++ - 0.5 * (room.count - 1)) * room.width_px;
      draw_bars(canvas, series, frame, room.width_px, shift_px);
    } else if (has_range && !series.band) {
      shift_px = 2.0 * (capped++ % 5 - 2);
    }
    if (has_range && series.band) draw_band(canvas, series, frame);
    if (has_range && !series.band) draw_caps(canvas, series, frame, shift_px);
    if (series.line && !series.bars) draw_line(canvas, series, frame);
    if (series.dots) draw_dots(canvas, series, frame);
  }
  cairo_restore(cr);
  if (empty && !chart.note.empty()) {
    canvas.text(box.left + 0.5 * box.width, box.top + 0.5 * box.height, chart.note,
                kLetters_px + 1.0, 0.5, kFaintInk);
  }
}

struct LegendEntry {
  const ChartSeries* series;
  double x_px;
  int row;
};

std::vector<LegendEntry> legend_of(const ChartPage& page) {
  const Canvas measure(1, 1);
  std::vector<LegendEntry> entries;
  std::set<std::string> seen;
  double x_px = kMargin_px;
  int row = 0;
  for (const Chart& chart : page.charts) {
    for (const ChartSeries& series : chart.series) {
      if (series.name.empty() || !seen.insert(series.name).second) continue;
      const double width =
          kLegendSample_px + 8.0 + measure.text_width(series.name, kLetters_px) + 24.0;
      if (x_px + width > page.width_px && x_px > kMargin_px) {
        x_px = kMargin_px;
        ++row;
      }
      entries.push_back({&series, x_px, row});
      x_px += width;
    }
  }
  return entries;
}

void draw_legend_entry(const Canvas& canvas, const LegendEntry& entry, double top_px) {
  cairo_t* cr = canvas.cairo();
  const ChartSeries& series = *entry.series;
  const double y = top_px + entry.row * kLegendRow_px + 16.0;
  if (series.bars || series.band) {
    canvas.set_color(series.style.color);
    cairo_rectangle(cr, entry.x_px, y - 11.0, kLegendSample_px, 12.0);
    cairo_fill(cr);
  } else if (series.line) {
    set_line(canvas, series.style, 2.6);
    cairo_move_to(cr, entry.x_px, y - 4.5);
    cairo_line_to(cr, entry.x_px + kLegendSample_px, y - 4.5);
    cairo_stroke(cr);
    cairo_set_dash(cr, nullptr, 0, 0.0);
  } else {
    canvas.set_color(series.style.color);
    cairo_arc(cr, entry.x_px + 0.5 * kLegendSample_px, y - 4.5, kDotRadius_px + 1.0, 0.0,
              2.0 * std::numbers::pi);
    cairo_fill(cr);
  }
  canvas.text(entry.x_px + kLegendSample_px + 8.0, y, series.name, kLetters_px, 0.0);
}

}  // namespace

void draw_charts(const ChartPage& page, const std::string& png_path) {
  const std::vector<LegendEntry> legend = legend_of(page);
  const double legend_px = legend.empty() ? 0.0 : (legend.back().row + 1) * kLegendRow_px + 6.0;
  const double title_px = page.title.empty() ? 8.0 : kPageTitle_px;
  const int rows = (static_cast<int>(page.charts.size()) + page.columns - 1) / page.columns;
  const Canvas canvas(page.width_px,
                      static_cast<int>(title_px + legend_px) + rows * page.chart_height_px);
  if (!page.title.empty()) canvas.text(kMargin_px, 27.0, page.title, 18.0, 0.0, kInk, true);
  for (const LegendEntry& entry : legend) draw_legend_entry(canvas, entry, title_px);
  const double across_px = (page.width_px - kMargin_px) / static_cast<double>(page.columns);
  for (std::size_t i = 0; i < page.charts.size(); ++i) {
    const int column = static_cast<int>(i) % page.columns, row = static_cast<int>(i) / page.columns;
    draw_chart(
        canvas, page.charts[i],
        {column * across_px + kYAxis_px,
         title_px + legend_px + row * page.chart_height_px + kChartHead_px,
         across_px - kYAxis_px - kMargin_px, page.chart_height_px - kChartHead_px - kXAxis_px});
  }
  canvas.save_png(png_path);
}

}  // namespace sandrunner::plot
