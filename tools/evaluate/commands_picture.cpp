// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/commands_picture.h"

#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "rt/plot/plot.h"

namespace sandrunner::evaluate {
namespace {

constexpr double kCellWidth_px = 44.0, kCellHeight_px = 30.0;
constexpr int kLeft_px = 64, kTop_px = 120, kAcross_px = 660, kDown_px = 370;
constexpr std::size_t kCells = kCommandColumns * kCommandRows;

/// Green where all survive, over yellow to red.
plot::Color shade(double survival) {
  if (survival >= 1.0) return {0.36, 0.68, 0.42};
  return {0.87, 0.35 + 0.5 * survival, 0.30};
}

struct Plot {
  double left, top;
  CommandPlane plane;
  double x(double vx_mps) const {
    return left + (vx_mps - commanded_vx_mps(0)) / 0.5 * kCellWidth_px + 0.5 * kCellWidth_px;
  }
  double y(double other) const {
    const double step = commanded_other(plane, 1) - commanded_other(plane, 0);
    return top + (commanded_other(plane, kCommandRows - 1) - other) / step * kCellHeight_px +
           0.5 * kCellHeight_px;
  }
};

/// Survival of each command on the ground that is worst for it.
std::vector<double> worst_survival(const PartResults& results, std::size_t policy,
                                   CommandPlane plane) {
  const std::size_t grounds = results.part.groups.size() / kCells / 2;
  const std::size_t first = plane == CommandPlane::kSideways ? 0 : grounds * kCells;
  std::vector<double> worst(kCells, 1.0);
  for (std::size_t i = 0; i < grounds * kCells; ++i) {
    const double value = pool(metric("survival"), results.runs[policy][first + i]).value;
    worst[i % kCells] = std::min(worst[i % kCells], value);
  }
  return worst;
}

void draw_envelope(const plot::Canvas& canvas, const Plot& at, const CommandEnvelope& e) {
  cairo_t* const cairo = canvas.cairo();
  canvas.set_color(plot::kInk);
  cairo_set_line_width(cairo, 2.0);
  if (at.plane == CommandPlane::kTurning) {
    cairo_rectangle(cairo, at.x(-e.backward_mps), at.y(e.yaw_radps),
                    at.x(e.forward_mps) - at.x(-e.backward_mps),
                    at.y(-e.yaw_radps) - at.y(e.yaw_radps));
  } else {
    constexpr int kPoints = 96;
    for (int i = 0; i <= kPoints; ++i) {
      const double angle = 2.0 * M_PI * i / kPoints;
      const double c = std::cos(angle);
      cairo_line_to(cairo, at.x(c * (c < 0.0 ? e.backward_mps : e.forward_mps)),
                    at.y(e.lateral_mps * std::sin(angle)));
    }
  }
  cairo_stroke(cairo);
}

void draw_plane(const plot::Canvas& canvas, const Plot& at, const std::vector<double>& survival,
                const std::string& title) {
  canvas.text(at.left, at.top - 10.0, title, 14.0, 0.0, plot::kInk, true);
  for (int column = 0; column < kCommandColumns; ++column) {
    for (int row = 0; row < kCommandRows; ++row) {
      const double value = survival[static_cast<std::size_t>(column) * kCommandRows + row];
      const double x = at.left + column * kCellWidth_px;
      const double y = at.top + (kCommandRows - 1 - row) * kCellHeight_px;
      canvas.set_color(shade(value));
      cairo_rectangle(canvas.cairo(), x, y, kCellWidth_px - 1.0, kCellHeight_px - 1.0);
      cairo_fill(canvas.cairo());
      canvas.text(x + 0.5 * kCellWidth_px, y + 0.5 * kCellHeight_px + 4.0,
                  fmt::format("{:.0f}", 100.0 * value), 11.0, 0.5, plot::kInk);
    }
  }
  for (int column = 0; column < kCommandColumns; ++column) {
    canvas.text(at.left + (column + 0.5) * kCellWidth_px,
                at.top + kCommandRows * kCellHeight_px + 15.0,
                fmt::format("{:.1f}", commanded_vx_mps(column)), 11.0, 0.5, plot::kFaintInk);
  }
  for (int row = 0; row < kCommandRows; ++row) {
    canvas.text(at.left - 6.0, at.top + (kCommandRows - 0.5 - row) * kCellHeight_px + 4.0,
                fmt::format("{:.1f}", commanded_other(at.plane, row)), 11.0, 1.0, plot::kFaintInk);
  }
  canvas.text(at.left + 0.5 * kCommandColumns * kCellWidth_px,
              at.top + kCommandRows * kCellHeight_px + 33.0,
              at.plane == CommandPlane::kSideways ? "vx across, vy up, m/s"
                                                  : "vx across, m/s; yaw rate up, rad/s",
              11.0, 0.5, plot::kFaintInk);
}

}  // namespace

void draw_commands(const PartResults& results, const std::vector<std::string>& policies,
                   const std::vector<CommandEnvelope>& envelopes, const std::string& path) {
  const plot::Canvas canvas(kLeft_px + kAcross_px * static_cast<int>(policies.size()),
                            kTop_px + 2 * kDown_px);
  canvas.text(kLeft_px, 36.0, "Survived commands", 20.0, 0.0, plot::kInk, true);
  canvas.text(kLeft_px, 62.0,
              fmt::format("% of {} robots on their feet after 6 s on the worst for it of dry sand, "
                          "hard ground and the softest sand.",
                          results.runs.at(0).at(0).size()),
              12.0, 0.0, plot::kFaintInk);
  canvas.text(kLeft_px, 80.0, "Outline: the policy's envelope, to which commands are held.", 12.0,
              0.0, plot::kFaintInk);
  for (std::size_t p = 0; p < policies.size(); ++p) {
    for (const CommandPlane plane : {CommandPlane::kSideways, CommandPlane::kTurning}) {
      const Plot at{kLeft_px + static_cast<double>(p) * kAcross_px,
                    kTop_px + (plane == CommandPlane::kSideways ? 0.0 : 1.0) * kDown_px, plane};
      draw_plane(canvas, at, worst_survival(results, p, plane),
                 fmt::format("{}: {}", policies[p],
                             plane == CommandPlane::kSideways ? "sideways" : "turning"));
      draw_envelope(canvas, at, envelopes[p]);
    }
  }
  canvas.save_png(path);
}

}  // namespace sandrunner::evaluate
