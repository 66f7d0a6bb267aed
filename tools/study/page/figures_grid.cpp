// SPDX-License-Identifier: BSD-3-Clause
// The figures of E7: maps over both stiffnesses, lines over each.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>

#include "rt/plot/heat_map.h"
#include "tools/study/evidence/controllers.h"
#include "tools/study/evidence/grid_evidence.h"
#include "tools/study/page/figures.h"

namespace sandrunner::study {
namespace {

constexpr double kMega = 1e-6;  // MN in N

struct Quantity {
  const char* name;
  const char* title;
  double scale;
  int digits;
  bool more_is_better;
};
constexpr Quantity kQuantities[] = {{"reward", "mean reward of a step", 1.0, 2, true},
                                    {"clearance_m", "mean foot clearance, mm", 1e3, 0, false}};

// The controllers that were run, in the order of the tables.
std::vector<const Controller*> ran(const Evidence& evidence) {
  std::vector<const Controller*> found;
  for (const char* key : grid_controllers()) {
    if (evidence.find("E7", key) != nullptr) found.push_back(find_controller(key));
  }
  return found;
}

// A value for each cell, nan where the cell is black.
std::vector<double> visible_cells(const Evidence& evidence, const Controller& controller,
                                  const Quantity& quantity) {
  std::vector<double> values = grid_medians(evidence, controller.key, quantity.name);
  const std::vector<double> success = grid_medians(evidence, controller.key, "success");
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = success[i] > kLeastSuccess ? quantity.scale * values[i] : std::nan("");
  }
  return values;
}

std::vector<std::string> labels(const std::vector<double>& values, double scale, int digits) {
  std::vector<std::string> text;
  for (const double value : std::set<double>(values.begin(), values.end())) {
    text.push_back(fmt::format("{:.{}f}", scale * value, digits));
  }
  return text;
}

// A quantity over one stiffness, a line for each controller: the mean over the other stiffness.
plot::Chart line_chart(const Evidence& evidence, const Quantity& quantity, const char* stiffness,
                       const char* label) {
  plot::Chart chart;
  chart.title = fmt::format("Over {}", label);
  chart.x_label = fmt::format("{}, MN/m\u00b3", label);
  chart.y_label = quantity.title;
  chart.note = "not run";
  for (const Controller* controller : ran(evidence)) {
    const Measured& any = evidence.find("E7", controller->key)->begin()->second;
    const std::vector<double>& at = grid_list(any, stiffness);
    const std::vector<double> values = visible_cells(evidence, *controller, quantity);
    plot::ChartSeries series;
    series.name = controller->name;
    series.style = controller->style;
    series.dots = true;
    for (const double x : std::set<double>(at.begin(), at.end())) {
      std::vector<double> of_x;
      for (std::size_t i = 0; i < at.size(); ++i) {
        if (at[i] == x) of_x.push_back(values[i]);
      }
      series.x.push_back(kMega * x);
      series.y.push_back(mean_of(of_x));
    }
    chart.series.push_back(series);
  }
  return chart;
}

}  // namespace

void draw_grid_maps(const Evidence& evidence, const std::string& png_path) {
  constexpr int kLeft_px = 56, kTop_px = 48, kAcross_px = 600, kDown_px = 350;
  const std::vector<const Controller*> all = ran(evidence);
  const plot::Canvas canvas(static_cast<int>(std::size(kQuantities)) * kAcross_px,
                            kTop_px + kDown_px * std::max(1, static_cast<int>(all.size())));
  int column = 0;
  for (const Quantity& quantity : kQuantities) {
    std::vector<std::vector<double>> values;
    double low = INFINITY, high = -INFINITY;
    for (const Controller* controller : all) {
      values.push_back(visible_cells(evidence, *controller, quantity));
      for (const double value : values.back()) {
        low = std::fmin(low, value);
        high = std::fmax(high, value);
      }
    }
    for (std::size_t row = 0; row < all.size(); ++row) {
      const Measured& any = evidence.find("E7", all[row]->key)->begin()->second;
      plot::HeatMap map;
      map.title = fmt::format("{}: {}", all[row]->name, quantity.title);
      map.values = values[row];
      map.column_labels = labels(grid_list(any, "sigma_flat_npm3"), kMega, 1);
      map.row_labels = labels(grid_list(any, "sigma_cone_npm3"), kMega, 2);
      map.caption = "sigma_flat across, sigma_cone up, MN/m\u00b3";
      map.low = low;
      map.high = high;
      map.digits = quantity.digits;
      map.dark_is_low = quantity.more_is_better;
      plot::draw_map(canvas, map, kLeft_px + column * kAcross_px,
                     kTop_px + static_cast<double>(row) * kDown_px);
    }
    ++column;
  }
  canvas.save_png(png_path);
}

std::vector<StudyFigure> grid_figures(const Evidence& evidence) {
  StudyFigure figure{"fig4_lines",
                     "not printed",
                     "Mean over the other stiffness, without black cells; medians over the seeds.",
                     {}};
  figure.page.title = "Over each stiffness";
  figure.page.columns = 2;
  for (const Quantity& quantity : kQuantities) {
    figure.page.charts.push_back(line_chart(evidence, quantity, "sigma_flat_npm3", "sigma_flat"));
    figure.page.charts.push_back(line_chart(evidence, quantity, "sigma_cone_npm3", "sigma_cone"));
  }
  return {figure};
}

}  // namespace sandrunner::study
