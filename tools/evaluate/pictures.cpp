// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/pictures.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <limits>

#include "rt/plot/heat_map.h"

namespace sandrunner::evaluate {
namespace {

constexpr plot::Color kPolicyColors[] = {{0.05, 0.35, 0.70}, {0.80, 0.40, 0.05}};
constexpr double kFastest_mps = 4.5;  // end of the speed axes
constexpr plot::Color kLightColors[] = {{0.45, 0.65, 0.90}, {0.95, 0.70, 0.45}};

// Grounds in their order, each with the indices of its groups.
std::vector<std::pair<std::string, std::vector<std::size_t>>> by_ground(const Part& part) {
  std::vector<std::pair<std::string, std::vector<std::size_t>>> out;
  for (std::size_t g = 0; g < part.groups.size(); ++g) {
    if (out.empty() || out.back().first != part.groups[g].ground) {
      out.push_back({part.groups[g].ground, {}});
    }
    out.back().second.push_back(g);
  }
  return out;
}

void draw_speed(const PartResults& results, const std::vector<std::string>& policies,
                const std::string& path) {
  plot::Figure figure;
  figure.title = "Straight run: speed against command";
  figure.x_label = "commanded speed, m/s";
  figure.width_px = 1100;
  figure.panel_height_px = 220;
  for (const auto& [ground, groups] : by_ground(results.part)) {
    plot::Panel panel{ground, "speed, m/s", {}, 1e-3, true};
    figure.x.clear();
    for (const std::size_t g : groups) figure.x.push_back(results.part.groups[g].command.vx_mps);
    panel.series.push_back({"command", plot::kFaintInk, figure.x, false, true});
    for (std::size_t p = 0; p < policies.size(); ++p) {
      plot::Series track{policies[p] + ", whole track", kPolicyColors[p], {}};
      plot::Series end{"its last gait cycle", kLightColors[p], {}};
      track.markers = end.markers = true;
      for (const std::size_t g : groups) {
        track.y.push_back(pool(metric("track_speed_mps"), results.runs[p][g]).value);
        end.y.push_back(pool(metric("track_end_speed_mps"), results.runs[p][g]).value);
      }
      panel.series.push_back(track);
      panel.series.push_back(end);
    }
    figure.panels.push_back(panel);
  }
  figure.views = {{"", 0.0, kFastest_mps, 1.0}};
  plot::draw(figure, path);
}

void draw_cost(const PartResults& results, const std::vector<std::string>& policies,
               const std::string& path) {
  constexpr double kStep_mps = 0.01;
  plot::Figure figure;
  figure.title = "Straight run: cost of transport against steady speed";
  figure.x_label = "steady speed, m/s";
  figure.width_px = 1100;
  figure.panel_height_px = 220;
  double greatest = 0.0;
  for (int i = 0; i * kStep_mps <= kFastest_mps; ++i) figure.x.push_back(i * kStep_mps);
  for (const auto& [ground, groups] : by_ground(results.part)) {
    plot::Panel panel{ground, "cost of transport", {}, 1e-3, true};
    for (std::size_t p = 0; p < policies.size(); ++p) {
      std::vector<std::pair<double, double>> points;
      for (const std::size_t g : groups) {
        const Estimate speed = pool(metric("vx_mps"), results.runs[p][g]);
        const Estimate cot = pool(metric("cot"), results.runs[p][g]);
        if (cot.n == 0) continue;
        points.emplace_back(speed.value, cot.value);
        greatest = std::max(greatest, cot.value);
      }
      plot::Series line{policies[p], kPolicyColors[p], {}};
      for (const double x : figure.x) line.y.push_back(interpolate(points, x));
      panel.series.push_back(line);
      plot::Series measured{"", kPolicyColors[p], {}};
      measured.markers = true;
      measured.y.assign(figure.x.size(), std::numeric_limits<double>::quiet_NaN());
      for (const auto& [speed, cot] : points) {
        const auto at = static_cast<std::size_t>(std::lround(speed / kStep_mps));
        if (at < measured.y.size()) measured.y[at] = cot;
      }
      panel.series.push_back(measured);
    }
    figure.panels.push_back(panel);
  }
  // One scale, so that grounds can be compared.
  for (plot::Panel& panel : figure.panels) panel.least_range = 1.12 * greatest;
  figure.views = {{"", 0.0, kFastest_mps, 1.0}};
  plot::draw(figure, path);
}

struct Map {
  const char* key;
  const char* title;
  bool more_is_better;
};

void draw_grid(const PartResults& results, const std::vector<std::string>& policies,
               const std::string& path) {
  constexpr Map kMaps[] = {{"survival", "survival, %", true},
                           {"velocity_error_mps", "velocity error, m/s", false},
                           {"yaw_error_radps", "yaw rate error, rad/s", false},
                           {"clearance_iqr_m", "foot clearance (IQR), mm", false}};
  constexpr int kLeft_px = 56, kTop_px = 86, kAcross_px = 560, kDown_px = 350;
  const auto count = static_cast<int>(policies.size());
  const plot::Canvas canvas(kLeft_px + kAcross_px * count,
                            kTop_px + kDown_px * static_cast<int>(std::size(kMaps)));
  canvas.text(
      kLeft_px, 32.0,
      fmt::format("Stiffness grid, {} robots in each cell", results.runs.at(0).at(0).size()), 20.0,
      0.0, plot::kInk, true);
  for (int row = 0; const Map& map : kMaps) {
    const Metric& m = metric(map.key);
    std::vector<std::vector<double>> values(policies.size());
    double low = INFINITY, high = -INFINITY;
    for (std::size_t p = 0; p < policies.size(); ++p) {
      for (const auto& runs : results.runs[p]) {
        values[p].push_back(pool(m, runs).value * m.table_scale);
        low = std::fmin(low, values[p].back());
        high = std::fmax(high, values[p].back());
      }
    }
    for (int p = 0; p < count; ++p) {
      plot::HeatMap cells;
      cells.title = fmt::format("{}: {}", policies[p], map.title);
      cells.values = values[p];
      for (int i = 0; i < kGridSize; ++i) {
        cells.column_labels.push_back(fmt::format("{:.0f}", 1.0 + i));
        cells.row_labels.push_back(fmt::format("{:.2f}", 0.15 + 0.05 * i));
      }
      cells.caption = "sigma_flat across, sigma_cone up, MN/m\u00b3";
      cells.low = low;
      cells.high = high;
      cells.digits = m.digits;
      cells.dark_is_low = map.more_is_better;
      plot::draw_map(canvas, cells, kLeft_px + p * kAcross_px, kTop_px + row * kDown_px);
    }
    ++row;
  }
  canvas.save_png(path);
}

}  // namespace

void draw_part(const PartResults& results, const std::vector<std::string>& policies,
               const std::string& dir) {
  if (results.part.name == "straight") {
    draw_speed(results, policies, dir + "/straight_speed.png");
    draw_cost(results, policies, dir + "/straight_cost.png");
  }
  if (results.part.name == "grid") draw_grid(results, policies, dir + "/grid.png");
}

}  // namespace sandrunner::evaluate
