// SPDX-License-Identifier: BSD-3-Clause
// The figures of the hidden state, of the ball on beads and of the trainings.
#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <numbers>
#include <sstream>

#include "rt/base/input_file.h"
#include "tools/study/evidence/controllers.h"
#include "tools/study/experiments/anchors.h"
#include "tools/study/page/figures.h"

namespace sandrunner::study {
namespace {

// A colour on a circle: a phase has no beginning.
plot::Color hue(double share) {
  const auto part = [&](double offset) {
    return 0.5 + 0.42 * std::cos(2.0 * std::numbers::pi * (share - offset));
  };
  return {part(0.0), part(1.0 / 3.0), part(2.0 / 3.0)};
}

plot::ChartSeries dots(const std::string& name, const plot::Color& color) {
  plot::ChartSeries series;
  series.name = name;
  series.style.color = color;
  series.line = false;
  series.dots = true;
  return series;
}

struct Column {
  const char *name, *title, *unit;
};

// The columns of a short learning curve, by name; a row for each line.
std::map<std::string, std::vector<double>> read_curve(const std::string& path) {
  std::istringstream lines(read_input_file(path, "a learning curve"));
  std::string line, cell;
  std::vector<std::string> names;
  std::map<std::string, std::vector<double>> columns;
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    const bool heading = names.empty();
    for (std::size_t i = 0; std::getline(cells, cell, ','); ++i) {
      if (heading) {
        names.push_back(cell);
      } else if (i < names.size()) {
        char* end = nullptr;
        const double value = std::strtod(cell.c_str(), &end);
        columns[names[i]].push_back(end == cell.c_str() ? std::nan("") : value);
      }
    }
  }
  return columns;
}

}  // namespace

std::vector<StudyFigure> hidden_state_figures(const Evidence& evidence) {
  StudyFigure figure{
      "fig3f",
      "\"embedded hidden states distributed distinctly for different terrains\"; no numbers",
      "Exact t-SNE of up to 2,000 states of the first seed at 1 m/s, from 8 runs of 10 s on each "
      "ground, perplexity 30, started from the principal components. Left: by ground. Right: by "
      "the phase of the left front foot. The numbers below the picture can fail; it cannot.",
      {}};
  figure.page.title = "Hidden states of Ours (Fig. 3 F)";
  figure.page.chart_height_px = 520;
  plot::Chart by_ground, by_phase;
  by_ground.title = "By ground";
  by_phase.title = "By phase of the gait";
  by_ground.note = by_phase.note = "not run";
  const auto* seeds = evidence.find("E4", "ours");
  if (seeds != nullptr && seeds->begin()->second.groups.at(0).lists.contains("x")) {
    const auto& lists = seeds->begin()->second.groups.at(0).lists;
    const char* const kGrounds[] = {"vinyl tile", "athletic track", "grass", "dry sand"};
    constexpr plot::Color kColors[] = {
        {0.35, 0.35, 0.38}, {0.75, 0.20, 0.20}, {0.10, 0.55, 0.20}, {0.85, 0.62, 0.10}};
    constexpr int kPhases = 8;
    for (int g = 0; g < 4; ++g) by_ground.series.push_back(dots(kGrounds[g], kColors[g]));
    for (int p = 0; p < kPhases; ++p) {
      by_phase.series.push_back(dots(fmt::format("phase {}/{}", p, kPhases), hue(p / 8.0)));
    }
    for (std::size_t i = 0; i < lists.at("x").size(); ++i) {
      const auto g = static_cast<std::size_t>(lists.at("ground")[i]);
      const auto p = static_cast<std::size_t>(kPhases * lists.at("phase")[i]) % kPhases;
      for (plot::ChartSeries* series : {&by_ground.series[g], &by_phase.series[p]}) {
        series->x.push_back(lists.at("x")[i]);
        series->y.push_back(lists.at("y")[i]);
      }
    }
  }
  figure.page.charts = {by_ground, by_phase};
  return {figure};
}

std::vector<StudyFigure> anchor_figures() {
  StudyFigure figure{"ball", "", "", {}};
  figure.page.title = "A steel ball of 25.4 mm dropped on glass beads";
  plot::Chart depth, time;
  depth.title = "Final depth";
  depth.y_label = "mm";
  time.title = "Stopping time";
  time.y_label = "ms";
  plot::ChartSeries theirs{"Katsuragi and Durian 2007", {{0.45, 0.45, 0.48}}, {}, {}};
  plot::ChartSeries ours{"our contact law", {{0.05, 0.32, 0.70}, {9.0, 4.0}}, {}, {}};
  ours.dots = true;
  plot::ChartSeries their_time = theirs, our_time = ours;
  for (int i = 0; i <= 35; ++i) {
    const double v = 0.5 + 0.1 * i;
    const Stop stop = katsuragi_durian(v);
    theirs.x.push_back(v);
    theirs.y.push_back(1e3 * stop.depth_m);
    their_time.x.push_back(v);
    their_time.y.push_back(1e3 * stop.time_s);
  }
  for (int i = 1; i <= 8; ++i) {
    const Stop stop = drop_ball({}, glass_beads(), 0.5 * i);
    ours.x.push_back(0.5 * i);
    ours.y.push_back(1e3 * stop.depth_m);
    our_time.x.push_back(0.5 * i);
    our_time.y.push_back(1e3 * stop.time_s);
  }
  depth.series = {theirs, ours};
  time.series = {their_time, our_time};
  for (plot::Chart* chart : {&depth, &time}) {
    chart->x_label = "speed at impact, m/s";
    chart->y_begin = 0.0;
  }
  figure.page.charts = {depth, time};
  return {figure};
}

std::vector<StudyFigure> learning_figures(const std::string& folder,
                                          const std::vector<std::string>& models) {
  constexpr Column kColumns[] = {
      {"battery_alive", "Share of the battery alive", ""},
      {"battery_error", "Velocity error of the battery, relative", ""},
      {"battery_cost_of_transport", "Cost of transport of the battery", ""}};
  StudyFigure figure{"curves",
                     "not printed",
                     "A line for each seed; the battery is run on the grounds of each training.",
                     {}};
  figure.page.title = "Learning curves";
  figure.page.columns = 3;
  for (const Column& column : kColumns) {
    plot::Chart chart;
    chart.title = column.title;
    chart.x_label = "million transitions";
    chart.y_label = column.unit;
    chart.y_begin = 0.0;
    chart.note = "no curves";
    for (const std::string& model : models) {
      const Controller& controller = *find_controller(model.substr(0, model.rfind('-')));
      const std::string path = folder + "/" + model + ".csv";
      if (!std::filesystem::exists(path)) continue;
      auto curve = read_curve(path);
      plot::ChartSeries series;
      series.name = controller.name;
      series.style = controller.style;
      series.x = curve["transitions"];
      for (double& x : series.x) x *= 1e-6;
      series.y = curve[column.name];
      if (series.x.size() == series.y.size() && !series.x.empty()) chart.series.push_back(series);
    }
    figure.page.charts.push_back(chart);
  }
  return {figure};
}

}  // namespace sandrunner::study
