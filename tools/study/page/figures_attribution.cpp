// SPDX-License-Identifier: BSD-3-Clause
// Fig. 4 E to G and S11: what the oracles' answers depend on.
#include <cmath>
#include <cstddef>

#include "tools/study/evidence/controllers.h"
#include "tools/study/experiments/oracles.h"
#include "tools/study/page/figures.h"

namespace sandrunner::study {
namespace {

struct Bar {
  const char* label;
  const char* names[2];  ///< of the figure: in Oracle(H), in Oracle(O)
};
constexpr Bar kGroups[] = {
    {"cmd", {"cmd", "cmd"}}, {"h or o", {"h", "o"}}, {"e", {"e", "e"}}, {"T", {"T", "T"}}};

/// Labels of kTerrainParameters on an axis; those that do not vary have no bars.
constexpr const char* kShortNames[] = {"rigid", "flat",  "cone",      "friction", "inertia",
                                       "rough", "recr.", "cone ang.", "str. k",   "str. b"};

/// Bars at x = 0, 1, ...: the median over the seeds, with the least and greatest as caps.
plot::ChartSeries bars(const std::string& name, const plot::Style& style,
                       const std::vector<Figure>& figures) {
  plot::ChartSeries series;
  series.name = name;
  series.style.color = style.color;
  series.line = false;
  series.bars = true;
  bool several = false;
  for (const Figure& figure : figures) {
    std::vector<double> values;
    for (const auto& [seed, value] : figure) values.push_back(value.value);
    series.x.push_back(static_cast<double>(series.x.size()));
    series.y.push_back(median(figure));
    series.low.push_back(least_of(values));
    series.high.push_back(greatest_of(values));
    several = several || values.size() > 1;
  }
  if (!several) series.low = series.high = {};
  return series;
}

plot::Chart group_chart(const Evidence& evidence) {
  plot::Chart chart;
  chart.title = "Ablation of groups of inputs (Fig. 4 E)";
  chart.y_label = "mean |change of an action|";
  chart.y_begin = 0.0;
  chart.note = "not run";
  for (const Bar& bar : kGroups) chart.categories.emplace_back(bar.label);
  for (std::size_t k = 0; k < oracle_controllers().size(); ++k) {
    const char* const oracle = oracle_controllers()[k];
    if (evidence.find("E8", oracle) == nullptr) continue;
    std::vector<Figure> figures;
    for (const Bar& bar : kGroups) {
      figures.push_back(oracle_ablation(evidence, oracle, bar.names[k]));
    }
    const Controller& controller = *find_controller(oracle);
    chart.series.push_back(bars(controller.name, controller.style, figures));
  }
  return chart;
}

plot::Chart stiffness_chart(const Evidence& evidence) {
  plot::Chart chart;
  chart.title = "Ablation of T by stiffness (Fig. 4 F)";
  chart.x_label = "log10 of sigma_flat in MN/m^3";
  chart.y_label = "mean |change of an action|";
  chart.y_begin = 0.0;
  chart.note = "not run";
  for (const char* oracle : oracle_controllers()) {
    const auto* seeds = evidence.find("E8", oracle);
    if (seeds == nullptr) continue;
    const Controller& controller = *find_controller(oracle);
    plot::ChartSeries series{controller.name, controller.style, {}, {}};
    series.dots = true;
    const std::vector<double>& sigma =
        seeds->begin()->second.select(kOracleGround).at(0)->lists.at("bin_sigma_npm3");
    for (std::size_t i = 0; i < sigma.size(); ++i) {
      std::vector<double> values;
      for (const auto& [seed, value] : oracle_value(evidence, oracle, "bin_T", i)) {
        values.push_back(value.value);
      }
      series.x.push_back(std::log10(1e-6 * sigma[i]));
      series.y.push_back(median_of(values));
      if (values.size() < 2) continue;
      series.low.push_back(least_of(values));
      series.high.push_back(greatest_of(values));
    }
    chart.series.push_back(series);
  }
  return chart;
}

/// A chart with a bar for each parameter of soil.
plot::Chart parameter_chart(const char* title, const char* y_label) {
  plot::Chart chart;
  chart.title = title;
  chart.y_label = y_label;
  chart.y_begin = 0.0;
  chart.note = "not run";
  for (std::size_t i = 0; i < std::size(kTerrainParameters); ++i) {
    if (kTerrainParameters[i].varies) chart.categories.emplace_back(kShortNames[i]);
  }
  return chart;
}

std::vector<Figure> of_parameters(const Evidence& evidence, const char* oracle, const char* list) {
  std::vector<Figure> figures;
  for (std::size_t i = 0; i < std::size(kTerrainParameters); ++i) {
    if (kTerrainParameters[i].varies) figures.push_back(oracle_value(evidence, oracle, list, i));
  }
  return figures;
}

plot::Chart joint_chart(const Evidence& evidence) {
  plot::Chart chart = parameter_chart("Integrated gradients by joint, Oracle(O) (Fig. 4 G)",
                                      "mean |integrated gradient|");
  const plot::Style kStyles[kJointsPerLeg] = {
      {{0.45, 0.45, 0.48}}, {{0.05, 0.32, 0.70}}, {{0.84, 0.37, 0.00}}};
  if (evidence.find("E8", "oracle-o") == nullptr) return chart;
  for (std::size_t k = 0; k < std::size(kOracleJoints); ++k) {
    chart.series.push_back(bars(kOracleJoints[k].name, kStyles[k],
                                of_parameters(evidence, "oracle-o", kOracleJoints[k].list)));
  }
  return chart;
}

plot::Chart alone_chart(const Evidence& evidence) {
  plot::Chart chart =
      parameter_chart("Ablation of each parameter alone (fig. S11)", "mean |change of an action|");
  for (const char* oracle : oracle_controllers()) {
    if (evidence.find("E8", oracle) == nullptr) continue;
    const Controller& controller = *find_controller(oracle);
    chart.series.push_back(
        bars(controller.name, controller.style, of_parameters(evidence, oracle, "alone")));
  }
  return chart;
}

}  // namespace

std::vector<StudyFigure> attribution_figures(const Evidence& evidence) {
  StudyFigure groups{
      "fig4ef",
      "\"much higher for the estimation group e_t compared with the terrain parameter group\"; "
      "\"Oracle(H) manifests less attribution for the terrain parameters than Oracle(O)\"; the "
      "values are not printed",
      "cmd: command; h: encoded history of Oracle(H); o: observation of Oracle(O); e: estimate; "
      "T: parameters of the ground. An action is a joint's target less its nominal position, in "
      "units of the network. Medians over the seeds; caps are the least and the greatest seed. "
      "Ten bins over all stiffnesses that the training draws, equal in the logarithm; the "
      "paper's axis is not printed.",
      {}};
  groups.page.title = "What the oracles' actions depend on (Fig. 4 E, F)";
  groups.page.charts = {group_chart(evidence), stiffness_chart(evidence)};
  StudyFigure parameters{
      "fig4g",
      "sigma_flat and sigma_cone \"were more substantial than the other parts, such as the "
      "inertial force of the ground\"; the values are not printed",
      "Integrated gradients from the mean input, means of their magnitudes over the states and the "
      "four legs. Both grow with the range from which a parameter was drawn: see its deviation in "
      "the table. The rigid flag and the roughness of hard ground do not vary on soil.",
      {}};
  parameters.page.title = "Parameters of the ground (Fig. 4 G, fig. S11)";
  parameters.page.charts = {joint_chart(evidence), alone_chart(evidence)};
  return {groups, parameters};
}

}  // namespace sandrunner::study
