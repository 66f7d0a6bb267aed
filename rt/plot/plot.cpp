// SPDX-License-Identifier: BSD-3-Clause
#include "rt/plot/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "rt/base/errors.h"
#include "rt/base/output_files.h"
#include "rt/plot/axes.h"

namespace sandrunner::plot {
namespace {

constexpr double kTextSize_px = 14.0;
constexpr double kTop_px = 80.0;     // figure title, titles of the views
constexpr double kBottom_px = 56.0;  // x axis
constexpr double kLeft_px = 86.0;    // y axis
constexpr double kRight_px = 22.0;
constexpr double kBetweenViews_px = 26.0;
constexpr double kPanelHead_px = 34.0;  // title and legend of a panel

/// Range of all finite values, a little wider.
Range range_of(const Panel& panel) {
  Range range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const Series& series : panel.series) {
    for (const double y : series.y) {
      if (!std::isfinite(y)) continue;
      range.begin = std::min(range.begin, y);
      range.end = std::max(range.end, y);
    }
  }
  if (range.begin > range.end) return {0.0, 1.0};
  const double middle = 0.5 * (range.begin + range.end);
  if (panel.from_zero) return {0.0, std::max(1.12 * range.end, panel.least_range)};
  const double width = std::max(1.12 * (range.end - range.begin), panel.least_range);
  return {middle - 0.5 * width, middle + 0.5 * width};
}

void draw_series(const Canvas& canvas, const Series& series, const std::vector<double>& x,
                 const Range& x_range, const Range& y_range, const Box& box) {
  cairo_t* cr = canvas.cairo();
  bool pen_down = false;
  double last_y_px = 0.0;
  for (const Point& point :
       decimate(x, series.y, x_range.begin, x_range.end, static_cast<int>(box.width))) {
    if (!std::isfinite(point.y)) {
      pen_down = false;
      continue;
    }
    const double x_px = map(point.x, x_range, box.left, box.left + box.width);
    const double y_px = map(point.y, y_range, box.top + box.height, box.top);
    if (!pen_down) {
      cairo_move_to(cr, x_px, y_px);
      cairo_line_to(cr, x_px, y_px);  // a single value between gaps is a dot
    } else {
      if (series.step) cairo_line_to(cr, x_px, last_y_px);
      cairo_line_to(cr, x_px, y_px);
    }
    pen_down = true;
    last_y_px = y_px;
  }
  const std::array<double, 2> dashes = {7.0, 4.0};
  cairo_set_dash(cr, dashes.data(), series.dashed ? 2 : 0, 0.0);
  cairo_set_line_width(cr, series.dashed ? 1.9 : series.width_px);
  cairo_set_line_join(cr, CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(cr, CAIRO_LINE_CAP_ROUND);
  canvas.set_color(series.color);
  cairo_stroke(cr);
  cairo_set_dash(cr, nullptr, 0, 0.0);
  for (std::size_t i = 0; series.markers && i < series.y.size(); ++i) {
    if (!std::isfinite(series.y[i])) continue;
    constexpr double kRadius_px = 4.0;
    cairo_new_sub_path(cr);
    cairo_arc(cr, map(x[i], x_range, box.left, box.left + box.width),
              map(series.y[i], y_range, box.top + box.height, box.top), kRadius_px, 0.0,
              2.0 * std::numbers::pi);
    cairo_fill(cr);
  }
}

void draw_legend(const Canvas& canvas, const Panel& panel, double right_px, double baseline_px) {
  constexpr double kSample_px = 26.0;
  double x_px = right_px;
  for (auto series = panel.series.rbegin(); series != panel.series.rend(); ++series) {
    if (series->name.empty()) continue;
    canvas.text(x_px, baseline_px, series->name, kTextSize_px, 1.0);
    x_px -= canvas.text_width(series->name, kTextSize_px) + 7.0 + kSample_px;
    cairo_t* cr = canvas.cairo();
    const std::array<double, 2> dashes = {7.0, 4.0};
    cairo_set_dash(cr, dashes.data(), series->dashed ? 2 : 0, 0.0);
    cairo_set_line_cap(cr, CAIRO_LINE_CAP_BUTT);
    cairo_set_line_width(cr, 2.0 * series->width_px);
    canvas.set_color(series->color);
    cairo_move_to(cr, x_px, baseline_px - 5.0);
    cairo_line_to(cr, x_px + kSample_px, baseline_px - 5.0);
    cairo_stroke(cr);
    cairo_set_dash(cr, nullptr, 0, 0.0);
    x_px -= 20.0;
  }
}

/// The shades of a view, behind all panels, with their labels in its head where there is room.
void draw_spans(const Canvas& canvas, const Figure& figure, const View& view, const Box& box) {
  cairo_t* cr = canvas.cairo();
  const Range x_range{view.begin, view.end};
  for (const Span& span : figure.spans) {
    const double begin = std::max(span.begin, view.begin);
    const double end = std::min(span.end, view.end);
    if (!(begin < end)) continue;
    const double left_px = map(begin, x_range, box.left, box.left + box.width);
    const double right_px = map(end, x_range, box.left, box.left + box.width);
    canvas.set_color(span.color);
    cairo_rectangle(cr, left_px, box.top, right_px - left_px, box.height);
    cairo_fill(cr);
    if (!view.title.empty()) continue;  // its head is taken
    if (canvas.text_width(span.label, kTextSize_px) + 6.0 > right_px - left_px) continue;
    canvas.text(0.5 * (left_px + right_px), box.top + 17.0, span.label, kTextSize_px, 0.5,
                kFaintInk);
  }
  canvas.text(box.left + 0.5 * box.width, box.top + 17.0, view.title, kTextSize_px, 0.5, kFaintInk);
}

void draw_y_axis(const Canvas& canvas, const Panel& panel, const Range& y_range, const Box& box) {
  const Ticks y_ticks = ticks_for(y_range, box.height, kPixelsPerYTick);
  for (const double y : y_ticks.values) {
    const double y_px = map(y, y_range, box.top + box.height, box.top);
    canvas.text(box.left - 8.0, y_px + 5.0, tick_label(y, y_ticks.step), kTextSize_px, 1.0);
  }
  cairo_t* cr = canvas.cairo();
  cairo_save(cr);
  cairo_translate(cr, 22.0, box.top + 0.5 * box.height);
  cairo_rotate(cr, -0.5 * std::numbers::pi);
  canvas.text(0.0, 0.0, panel.y_label, kTextSize_px, 0.5, kFaintInk);
  cairo_restore(cr);
}

void draw_x_axis(const Canvas& canvas, const Figure& figure, const Range& x_range, const Box& box) {
  const Ticks x_ticks = ticks_for(x_range, box.width, kPixelsPerXTick);
  for (const double x : x_ticks.values) {
    const double x_px = map(x, x_range, box.left, box.left + box.width);
    canvas.text(x_px, box.top + box.height + 20.0, tick_label(x, x_ticks.step), kTextSize_px, 0.5);
  }
  canvas.text(box.left + 0.5 * box.width, box.top + box.height + 42.0, figure.x_label, kTextSize_px,
              0.5, kFaintInk);
}

}  // namespace

Canvas::Canvas(int width_px, int height_px)
    : surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_px, height_px),
               cairo_surface_destroy),
      context_(cairo_create(surface_.get()), cairo_destroy) {
  set_color({1.0, 1.0, 1.0});
  cairo_paint(cairo());
}

void Canvas::set_color(const Color& color) const {
  cairo_set_source_rgba(cairo(), color.red, color.green, color.blue, color.alpha);
}

double Canvas::text_width(const std::string& text, double size_px, bool bold) const {
  cairo_select_font_face(cairo(), "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo(), size_px);
  cairo_text_extents_t extents;
  cairo_text_extents(cairo(), text.c_str(), &extents);
  return extents.x_advance;
}

void Canvas::text(double x_px, double y_px, const std::string& text, double size_px, double anchor,
                  const Color& color, bool bold) const {
  const double width_px = text_width(text, size_px, bold);  // chooses the font too
  set_color(color);
  cairo_move_to(cairo(), x_px - anchor * width_px, y_px);
  cairo_show_text(cairo(), text.c_str());
  cairo_new_path(cairo());
}

void Canvas::save_png(const std::string& path) const {
  WholeFile file(path);
  cairo_status_t status = cairo_status(cairo());
  if (status == CAIRO_STATUS_SUCCESS) {
    status = cairo_surface_write_to_png(surface_.get(), file.part_path().c_str());
  }
  if (status != CAIRO_STATUS_SUCCESS) {
    throw InputError(
        fmt::format("{}: cannot be written ({})", path, cairo_status_to_string(status)));
  }
  file.keep();
}

std::vector<double> ticks(double begin, double end, int most) {
  std::vector<double> result;
  if (!(begin < end) || !std::isfinite(end - begin) || most < 1) return result;
  // One power of ten below the coarsest that can be needed; the first step that is coarse enough
  // wins.
  const int exponent = static_cast<int>(std::floor(std::log10((end - begin) / most)));
  for (int i = 0; i < 9; ++i) {
    constexpr std::array<double, 3> kMantissas = {1.0, 2.0, 5.0};
    const double power = std::pow(10.0, std::abs(exponent + i / 3));
    const auto value = [&](double count) {
      const double multiple = count * kMantissas[static_cast<std::size_t>(i % 3)];
      return exponent + i / 3 < 0 ? multiple / power : multiple * power;  // exact where it can be
    };
    const double first = std::ceil(begin / value(1.0) - 1e-9);
    const double last = std::floor(end / value(1.0) + 1e-9);
    if (last - first + 1.0 > most) continue;
    // Counted, as a step more may be no other number.
    for (int n = 0; n <= static_cast<int>(last - first); ++n) result.push_back(value(first + n));
    break;
  }
  return result;
}

std::string tick_label(double value, double step) {
  const int digits = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  std::string label = fmt::format("{:.{}f}", value == 0.0 ? 0.0 : value, digits);
  if (label[0] == '-') label.replace(0, 1, "\u2212");  // as long as a digit
  return label;
}

std::vector<Point> decimate(const std::vector<double>& x, const std::vector<double>& y,
                            double begin, double end, int columns) {
  std::vector<Point> points;
  const std::size_t size = std::min(x.size(), y.size());
  std::size_t first = static_cast<std::size_t>(
      std::lower_bound(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(size), begin) -
      x.begin());
  std::size_t last = static_cast<std::size_t>(
      std::upper_bound(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(size), end) - x.begin());
  if (first > 0) --first;
  if (last < size) ++last;
  const auto column = [&](std::size_t i) {
    return std::floor((x[i] - begin) / (end - begin) * columns);
  };
  for (std::size_t i = first; i < last;) {
    if (!std::isfinite(y[i])) {
      points.push_back({x[i], std::numeric_limits<double>::quiet_NaN()});
      ++i;
      continue;
    }
    std::size_t least = i;
    std::size_t greatest = i;
    std::size_t next = i;
    for (; next < last && std::isfinite(y[next]) && column(next) == column(i); ++next) {
      if (y[next] < y[least]) least = next;
      if (y[next] > y[greatest]) greatest = next;
    }
    std::array<std::size_t, 4> chosen = {i, std::min(least, greatest), std::max(least, greatest),
                                         next - 1};
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      if (k > 0 && chosen[k] == chosen[k - 1]) continue;
      points.push_back({x[chosen[k]], y[chosen[k]]});
    }
    i = next;
  }
  return points;
}

int height_px(const Figure& figure) {
  return static_cast<int>(kTop_px + kBottom_px) +
         static_cast<int>(figure.panels.size()) * figure.panel_height_px;
}

void draw(const Figure& figure, const std::string& png_path) {
  const Canvas canvas(figure.width_px, height_px(figure));
  canvas.text(kLeft_px, 32.0, figure.title, 20.0, 0.0, kInk, true);
  double shares = 0.0;
  for (const View& view : figure.views) shares += view.width_share;
  const double gaps_px = kBetweenViews_px * (static_cast<double>(figure.views.size()) - 1.0);
  const double usable_px = figure.width_px - kLeft_px - kRight_px - gaps_px;

  std::vector<Box> columns;
  for (const View& view : figure.views) {
    const double left_px =
        columns.empty() ? kLeft_px : columns.back().left + columns.back().width + kBetweenViews_px;
    columns.push_back({left_px, kTop_px - kPanelHead_px, usable_px * view.width_share / shares,
                       height_px(figure) - kTop_px + kPanelHead_px - kBottom_px});
    draw_spans(canvas, figure, view, columns.back());
  }
  double top_px = kTop_px;
  for (const Panel& panel : figure.panels) {
    const Range y_range = range_of(panel);
    canvas.text(kLeft_px + 2.0, top_px + 24.0, panel.title, kTextSize_px + 1.0, 0.0, kInk, true);
    draw_legend(canvas, panel, figure.width_px - kRight_px, top_px + 24.0);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const Range x_range{figure.views[i].begin, figure.views[i].end};
      const Box box{columns[i].left, top_px + kPanelHead_px, columns[i].width,
                    figure.panel_height_px - kPanelHead_px};
      draw_frame(canvas, x_range, y_range, box);
      cairo_save(canvas.cairo());
      cairo_rectangle(canvas.cairo(), box.left, box.top, box.width, box.height);
      cairo_clip(canvas.cairo());
      for (const Series& series : panel.series) {
        draw_series(canvas, series, figure.x, x_range, y_range, box);
      }
      cairo_restore(canvas.cairo());
      if (i == 0) draw_y_axis(canvas, panel, y_range, box);
      if (&panel == &figure.panels.back()) draw_x_axis(canvas, figure, x_range, box);
    }
    top_px += figure.panel_height_px;
  }
  canvas.save_png(png_path);
}

}  // namespace sandrunner::plot
