// SPDX-License-Identifier: BSD-3-Clause
// What the files with figures share, and the figures of the beach.
#include "tools/study/page/figures.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>

#include "tools/study/analysis/curve_fit.h"
#include "tools/study/evidence/controllers.h"
#include "tools/study/experiments/lab.h"

namespace sandrunner::study {
namespace {

constexpr double kFastest_mps = 4.2;  // end of the axes of speed

double median_of(const std::map<int, Measured>& seeds,
                 const std::function<double(const Measured&)>& of) {
  Figure figure;  // of the seeds that have it: one may have no success at a command
  for (const auto& [seed, measured] : seeds) {
    const double value = of(measured);
    if (!std::isnan(value)) figure[seed] = {value};
  }
  return median(figure);
}

// The extreme of a figure over the successful runs of all seeds.
double extreme(const std::map<int, Measured>& seeds, const CommandChart& wanted, double command,
               const char* name, double (*of)(const std::vector<double>&)) {
  std::vector<double> values;
  for (const auto& [seed, measured] : seeds) {
    for (const RunGroup* group : between(measured.select(wanted.ground), command, command)) {
      const auto &all = group->values(name), &success = group->values("success");
      for (std::size_t i = 0; i < all.size(); ++i) {
        if (success[i] == 1.0) values.push_back(all[i]);
      }
    }
  }
  return of(values);
}

// The torques of one leg of one controller over the second of its run nearest to 1 m/s.
plot::Chart torque_chart(const Controller& controller, const Measured& measured,
                         const std::string& leg) {
  const plot::Style kJoints[] = {
      {{0.45, 0.45, 0.48}, {2.0, 3.0}}, {{0.05, 0.32, 0.70}}, {{0.84, 0.37, 0.00}, {8.0, 3.0}}};
  plot::Chart chart;
  chart.title = fmt::format("{}, {}", controller.name, leg);
  chart.x_label = "time, s";
  chart.y_label = "torque, N m";
  chart.y_begin = -65.0;
  chart.y_end = 65.0;
  chart.note = "no run near 1 m/s";
  for (int joint = 0; joint < kJointsPerLeg; ++joint) {
    const char* const kNames[] = {"HAA", "HFE", "KFE"};
    const RunGroup& group = *measured.select("beach", "torques").at(0);
    const auto found = group.lists.find(leg + " " + kNames[joint]);
    if (found == group.lists.end()) continue;
    plot::ChartSeries series;
    series.name = kNames[joint];
    series.style = kJoints[joint];
    series.y = found->second;
    for (std::size_t i = 0; i < series.y.size(); ++i) {
      series.x.push_back(kStep_s * static_cast<double>(i));
    }
    chart.series.push_back(series);
  }
  return chart;
}

StudyFigure torque_figure(const Evidence& evidence) {
  StudyFigure figure{"fig2f",
                     "the run nearest to 1.0 m/s of each controller; \"Ours used lower peak "
                     "torques than the other controllers\"; the values are not printed",
                     "Extension is positive for HFE and KFE. One second at 100 Hz, first seed.",
                     {}};
  figure.page.title = "Torques of the right legs at about 1 m/s on dry sand (Fig. 2 F)";
  figure.page.chart_height_px = 250;
  for (const char* leg : {"RF", "RH"}) {
    int columns = 0;
    for (const char* key : beach_controllers()) {
      const auto* seeds = evidence.find("E1", key);
      if (seeds == nullptr) continue;
      figure.page.charts.push_back(
          torque_chart(*find_controller(key), seeds->begin()->second, leg));
      ++columns;
    }
    figure.page.columns = std::max(columns, 1);
  }
  return figure;
}

CommandChart success_chart() {
  return {"E1", "beach", "Success (Fig. 2 D)", "success, %", "success", 100.0, false};
}

CommandChart clearance_chart() {
  return {"E1", "beach",       "Foot clearance, IQR (Fig. 2 E)",
          "mm", "iqr_m",       1e3,
          true, "iqr_least_m", "iqr_greatest_m"};
}

}  // namespace

plot::Chart command_chart(const Evidence& evidence, const CommandChart& wanted) {
  plot::Chart chart;
  chart.title = wanted.title;
  chart.x_label = "commanded speed, m/s";
  chart.y_label = wanted.y_label;
  chart.x_begin = 0.0;
  chart.x_end = kFastest_mps;
  chart.y_begin = 0.0;
  chart.note = "not run";
  if (std::string_view(wanted.name) == "success") chart.y_end = 105.0;
  for (const Controller& controller : controllers()) {
    const auto* seeds = evidence.find(wanted.experiment, controller.key);
    if (seeds == nullptr) continue;
    plot::ChartSeries series;
    series.name = controller.name;
    series.style = controller.style;
    series.dots = true;
    for (const double command : straight_commands()) {
      series.x.push_back(command);
      series.y.push_back(wanted.scale * median_of(*seeds, [&](const Measured& m) {
                           const auto groups = between(m.select(wanted.ground), command, command);
                           return (wanted.of_successes ? mean_of_successes(groups, wanted.name)
                                                       : mean_value(groups, wanted.name))
                               .value;
                         }));
      if (wanted.low == nullptr) continue;
      series.low.push_back(wanted.scale * extreme(*seeds, wanted, command, wanted.low, least_of));
      series.high.push_back(wanted.scale *
                            extreme(*seeds, wanted, command, wanted.high, greatest_of));
    }
    chart.series.push_back(series);
  }
  return chart;
}

plot::Chart cost_chart(const Evidence& evidence, const char* experiment, const char* ground,
                       const char* title) {
  plot::Chart chart;
  chart.title = title;
  chart.x_label = "average speed, m/s";
  chart.y_label = "cost of transport";
  chart.x_begin = 0.0;
  chart.x_end = kFastest_mps;
  chart.y_begin = 0.0;
  chart.note = "not run";
  for (const Controller& controller : controllers()) {
    const auto* seeds = evidence.find(experiment, controller.key);
    if (seeds == nullptr) continue;
    plot::ChartSeries dots;
    dots.style.color = controller.style.color;
    dots.style.color.alpha = 0.35;
    dots.line = false;
    dots.dots = true;
    for (const auto& [seed, measured] : *seeds) {
      for (const RunGroup* group : measured.select(ground)) {
        const auto& success = group->values("success");
        for (std::size_t i = 0; i < success.size(); ++i) {
          if (success[i] != 1.0) continue;
          dots.x.push_back(group->values("speed_mps")[i]);
          dots.y.push_back(group->values("cot")[i]);
        }
      }
    }
    plot::ChartSeries line;
    line.name = controller.name;
    line.style = controller.style;
    if (const auto curve = fit_cot_curve(dots.x, dots.y)) {
      const double begin = least_of(dots.x), end = greatest_of(dots.x);
      for (int i = 0; i <= 100; ++i) {
        line.x.push_back(begin + 0.01 * i * (end - begin));
        line.y.push_back(curve->at(line.x.back()));
      }
    }
    chart.series.push_back(dots);
    chart.series.push_back(line);
  }
  return chart;
}

std::vector<StudyFigure> beach_figures(const Evidence& evidence) {
  StudyFigure figure{
      "fig2cde",
      "success overall: Ours 100 %, PL/Env-GM 72.5 %, Env-Rigid 50 %, PL/Env-Rigid 37.5 %, "
      "Env-Linear 17.5 %; cost and clearance are not printed",
      "C: a dot is a successful run, the curve a e^(bx) + cx + d (the paper prints b twice). E: "
      "the line is the mean over feet and successful runs, the caps are the least and the "
      "greatest foot of any run. Lines are medians over the seeds that have a success.",
      {}};
  figure.page.title = "Dry sand (Fig. 2 C, D, E)";
  figure.page.columns = 3;
  figure.page.chart_height_px = 380;
  figure.page.charts = {cost_chart(evidence, "E1", "beach", "Cost of transport (Fig. 2 C)"),
                        command_chart(evidence, success_chart()),
                        command_chart(evidence, clearance_chart())};
  return {figure, torque_figure(evidence)};
}

StudyFigure summary_figure(const Evidence& evidence) {
  StudyFigure figure{"summary", "", "", {}};
  figure.page.title = "Simulated dry sand: controllers trained on different grounds";
  figure.page.columns = 2;
  figure.page.charts = {command_chart(evidence, success_chart()),
                        command_chart(evidence, {"E1", "beach", "Average speed over 5 m", "m/s",
                                                 "speed_mps", 1.0, true, "speed_mps", "speed_mps"}),
                        cost_chart(evidence, "E1", "beach", "Cost of transport (Fig. 2 C)"),
                        command_chart(evidence, clearance_chart())};
  return figure;
}

}  // namespace sandrunner::study
