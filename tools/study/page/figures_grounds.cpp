// SPDX-License-Identifier: BSD-3-Clause
// The figures of E3, E5, E6 and of the estimator.
#include <fmt/format.h>

#include <cmath>
#include <cstddef>

#include "tools/study/evidence/controllers.h"
#include "tools/study/experiments/lab.h"
#include "tools/study/page/figures.h"

namespace sandrunner::study {
namespace {

struct Ground {
  const char* key;
  const char* name;
};
constexpr Ground kHarder[] = {
    {"vinyl", "vinyl tile"}, {"athletic-track", "athletic track"}, {"grass", "grass"}};
constexpr Ground kTurned[] = {{"dry-sand", "dry sand"},
                              {"wet-sand", "wet sand"},
                              {"grass", "grass"},
                              {"athletic-track", "track"},
                              {"vinyl", "vinyl"}};

// Bars of a figure of turns, a series for each controller, with the least and greatest run.
struct TurnBars {
  const char* experiment;
  std::vector<Ground> grounds;
  const char* name;
  double scale;
  bool of_successes, caps;
};

std::vector<plot::ChartSeries> turn_bars(const Evidence& evidence, const TurnBars& wanted,
                                         double rate_radps) {
  std::vector<plot::ChartSeries> all;
  for (const Controller& controller : controllers()) {
    const auto* seeds = evidence.find(wanted.experiment, controller.key);
    if (seeds == nullptr) continue;
    plot::ChartSeries series;
    series.name = controller.name;
    series.style = controller.style;
    series.bars = true;
    for (std::size_t g = 0; g < wanted.grounds.size(); ++g) {
      std::vector<double> values;
      Figure figure;
      for (const auto& [seed, measured] : *seeds) {
        std::vector<const RunGroup*> both;
        for (const RunGroup* group : measured.select(wanted.grounds[g].key, "turn")) {
          if (std::fabs(group->command) == rate_radps) both.push_back(group);
        }
        figure[seed] = wanted.of_successes ? mean_of_successes(both, wanted.name)
                                           : mean_value(both, wanted.name);
        for (const RunGroup* group : both) {
          for (std::size_t i = 0; i < group->size(); ++i) {
            const bool counts = !wanted.of_successes || group->values("success")[i] == 1.0;
            if (counts) values.push_back(group->values(wanted.name)[i]);
          }
        }
      }
      series.x.push_back(static_cast<double>(g));
      series.y.push_back(wanted.scale * median(figure));
      if (!wanted.caps) continue;
      series.low.push_back(wanted.scale * least_of(values));
      series.high.push_back(wanted.scale * greatest_of(values));
    }
    all.push_back(series);
  }
  return all;
}

plot::Chart turn_chart(const char* title, const char* y_label,
                       std::vector<plot::ChartSeries> series, const std::vector<Ground>& grounds) {
  plot::Chart chart;
  chart.title = title;
  chart.y_label = y_label;
  chart.series = std::move(series);
  chart.y_begin = 0.0;
  chart.note = "not run";
  for (const Ground& ground : grounds) chart.categories.emplace_back(ground.name);
  return chart;
}

}  // namespace

std::vector<StudyFigure> ground_figures(const Evidence& evidence) {
  StudyFigure straight{
      "fig3de",
      "top speeds of Ours 3.13 m/s on grass, 3.62 on the track, 3.76 on vinyl; Env-Rigid 6.1 % "
      "slower on the track and 10.1 % on grass; costs are not printed",
      "5 m to speed up, then 5 m of track, as in the paper. Ours was trained on hard ground (as "
      "vinyl) and on soils of the kind of our grass, never on springs (as the track).",
      {}};
  straight.page.title = "Vinyl tile, athletic track and grass (Fig. 3 D, E)";
  straight.page.columns = 3;
  for (const Ground& ground : kHarder) {
    straight.page.charts.push_back(
        cost_chart(evidence, "E3", ground.key, fmt::format("Cost, {}", ground.name).c_str()));
  }
  for (const Ground& ground : kHarder) {
    const std::string title = fmt::format("Speed, {}", ground.name);
    straight.page.charts.push_back(
        command_chart(evidence, {"E3", ground.key, title.c_str(), "average speed, m/s", "speed_mps",
                                 1.0, true, "speed_mps", "speed_mps"}));
  }
  StudyFigure turns{"turns",
                    "0.92 rad/s on dry sand, \"in all terrains\" around 0.94 rad/s; the command "
                    "is not printed",
                    "10 s on the spot, as many runs each way; caps: least and greatest run.",
                    {}};
  turns.page.title = "Yaw rate at a command of 1 rad/s";
  turns.page.columns = 1;
  const std::vector<Ground> grounds(std::begin(kTurned), std::end(kTurned));
  turns.page.charts = {turn_chart(
      "", "rad/s", turn_bars(evidence, {"E3", grounds, "yaw_rate_radps", 1.0, false, true}, 1.0),
      grounds)};
  return {straight, turns};
}

std::vector<StudyFigure> mattress_figures(const Evidence& evidence) {
  StudyFigure figure{"fig3h",
                     "Ours turns at 0.71 rad/s, and at 1.54 rad/s for 2 rad/s; PL/Env-Rigid never "
                     "makes half a turn; rates and costs of turning are not printed",
                     "As many runs each way; the paper has five. Success: more than half a turn "
                     "in 10 s without a contact of base or thigh.",
                     {}};
  figure.page.title = "Air mattress at a command of 1 rad/s (Fig. 3 H)";
  figure.page.columns = 3;
  const std::vector<Ground> mattress = {{"air-mattress", "air mattress"}};
  const auto bars = [&](const char* name, double scale, bool of_successes, bool caps) {
    return turn_bars(evidence, {"E5", mattress, name, scale, of_successes, caps}, 1.0);
  };
  plot::Chart success = turn_chart("Success", "%", bars("success", 100.0, false, false), mattress);
  success.y_end = 105.0;
  figure.page.charts = {
      success, turn_chart("Cost of turning", "", bars("cotu", 1.0, true, true), mattress),
      turn_chart("Yaw rate", "rad/s", bars("yaw_rate_radps", 1.0, false, true), mattress)};
  return {figure};
}

std::vector<StudyFigure> foam_figures(const Evidence& evidence) {
  StudyFigure figure{"s8",
                     "\"could stably traverse over it with a command at 0.5 m/s\"; no numbers",
                     "Run 0 of the first seed. The foam begins at 2 m. It is an overdamped "
                     "spring; no foam was measured.",
                     {}};
  figure.page.title = "From hard ground onto memory foam at 0.5 m/s (fig. S8)";
  plot::Chart depth, speed;
  depth.title = "Deepest foot";
  depth.y_label = "mm";
  speed.title = "Speed";
  speed.y_label = "m/s";
  for (plot::Chart* chart : {&depth, &speed}) {
    chart->x_label = "distance, m";
    chart->note = "not run";
  }
  for (const Controller& controller : controllers()) {
    const auto* seeds = evidence.find("E6", controller.key);
    if (seeds == nullptr) continue;
    const RunGroup& group = seeds->begin()->second.groups.at(0);
    plot::ChartSeries series;
    series.name = controller.name;
    series.style = controller.style;
    series.x = group.lists.at("x_m");
    series.y = group.lists.at("speed_mps");
    speed.series.push_back(series);
    series.y = group.lists.at("depth_m");
    for (double& y : series.y) y *= 1e3;
    depth.series.push_back(series);
  }
  figure.page.charts = {depth, speed};
  return {figure};
}

std::vector<StudyFigure> estimator_figures(const Evidence& evidence) {
  StudyFigure figure{"s4",
                     "not printed",
                     "Root mean square error over the steady half of each run, mean over the runs "
                     "without a fall.",
                     {}};
  figure.page.title = "The estimate of Ours (section S4)";
  figure.page.columns = 3;
  struct Part {
    const char *name, *title, *unit;
    double scale;
  };
  constexpr Part kParts[] = {{"velocity_rmse_mps", "Velocity", "m/s", 1.0},
                             {"body_height_rmse_m", "Body height", "mm", 1e3},
                             {"foot_height_rmse_m", "Foot heights", "mm", 1e3}};
  const plot::Style kGrounds[] = {{{0.80, 0.58, 0.10}},
                                  {{0.35, 0.35, 0.38}, {9.0, 4.0}},
                                  {{0.75, 0.20, 0.20}, {3.0, 3.0}},
                                  {{0.10, 0.55, 0.20}, {9.0, 3.0, 2.0, 3.0}}};
  for (const Part& part : kParts) {
    plot::Chart chart;
    chart.title = part.title;
    chart.x_label = "commanded speed, m/s";
    chart.y_label = part.unit;
    chart.y_begin = 0.0;
    chart.note = "not run";
    for (int g = 0; g < 4; ++g) {
      const Ground ground = g == 0 ? Ground{"beach", "dry sand"} : kHarder[g - 1];
      plot::ChartSeries series;
      series.name = ground.name;
      series.style = kGrounds[g];
      series.dots = true;
      for (const double command : straight_commands()) {
        const Figure error = evidence.figure(g == 0 ? "E1" : "E3", "ours", [&](const Measured& m) {
          return mean_value(between(m.select(ground.key), command, command), part.name);
        });
        if (error.empty()) continue;
        series.x.push_back(command);
        series.y.push_back(part.scale * median(error));
      }
      if (!series.x.empty()) chart.series.push_back(series);
    }
    figure.page.charts.push_back(chart);
  }
  return {figure};
}

}  // namespace sandrunner::study
