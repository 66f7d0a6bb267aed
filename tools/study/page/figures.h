// SPDX-License-Identifier: BSD-3-Clause
// The figures of the page, from what was measured.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "rt/plot/chart.h"
#include "tools/study/evidence/evidence.h"

namespace sandrunner::study {

struct StudyFigure {
  std::string name;   ///< of its PNG
  std::string paper;  ///< what the paper prints of it; empty: nothing
  std::string note;   ///< what differs from the paper, and what is shown
  plot::ChartPage page;
};

// Nothing to draw where nothing was measured: an empty page.

/// Fig. 2 C, D, E and F: E1.
std::vector<StudyFigure> beach_figures(const Evidence& evidence);
/// Fig. 3 D, E and the turns: E3.
std::vector<StudyFigure> ground_figures(const Evidence& evidence);
/// Fig. 3 F: E4.
std::vector<StudyFigure> hidden_state_figures(const Evidence& evidence);
/// Fig. 3 H: E5; S8: E6.
std::vector<StudyFigure> mattress_figures(const Evidence& evidence);
std::vector<StudyFigure> foam_figures(const Evidence& evidence);
/// Fig. 4 A to D: E7. Maps of reward and clearance, all controllers on one scale, to a PNG; lines
/// over each stiffness.
void draw_grid_maps(const Evidence& evidence, const std::string& png_path);
std::vector<StudyFigure> grid_figures(const Evidence& evidence);
/// Fig. 4 E, F, G and S11: E8.
std::vector<StudyFigure> attribution_figures(const Evidence& evidence);
/// S4: the network's estimate in the runs of E1 and E3.
std::vector<StudyFigure> estimator_figures(const Evidence& evidence);
/// The ball dropped on beads.
std::vector<StudyFigure> anchor_figures();
/// Curves NAME-SEED.csv of `folder`, of the models that were loaded.
std::vector<StudyFigure> learning_figures(const std::string& folder,
                                          const std::vector<std::string>& models);
/// Success, speed, cost and clearance on the beach, in one picture.
StudyFigure summary_figure(const Evidence& evidence);

// What the files with figures share.

/// The three or so charts of a figure against the command, a line for each controller that was run:
/// the median over seeds of `of`, and, with `caps`, the least and greatest value of any run.
struct CommandChart {
  const char* experiment;
  const char* ground;
  const char* title;
  const char* y_label;
  const char* name;    ///< of the figure in RunGroup::runs
  double scale = 1.0;  ///< from SI
  bool of_successes = true;
  const char *low = nullptr, *high = nullptr;  ///< figures of the caps; null: none
};
plot::Chart command_chart(const Evidence& evidence, const CommandChart& wanted);
/// Cost of transport against average speed: a dot for each run, and the fitted curve.
plot::Chart cost_chart(const Evidence& evidence, const char* experiment, const char* ground,
                       const char* title);

}  // namespace sandrunner::study
