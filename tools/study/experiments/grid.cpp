// SPDX-License-Identifier: BSD-3-Clause
// E7, Fig. 4 A to D: rewards and clearances over a grid of stiffnesses. Three groups on "grid":
//   cells: lists, a value for each cell: sigma_flat_npm3, sigma_cone_npm3, static_depth_m, success,
//     reward, clearance_m (nan where the success is not above kLeastSuccess)
//   robots: a run is a robot, which has the same start and command in each cell: reward and
//     success, means over the cells; slope_flat_m, slope_cone_m, of its clearance
//   terms: lists, one value each: the terms of the reward (train::reward_term_names), means over
//     cells and robots
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "tools/study/experiments/experiments.h"
#include "tools/study/simulated/grid_run.h"

namespace sandrunner::study {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kGround = "grid";
// The paper's criterion: a cell with no more success than this is black.
constexpr double kLeastSuccess = 0.10;

// [cell][robot]
using Cells = std::vector<std::vector<GridRobot>>;

double success_of(const std::vector<GridRobot>& robots) {
  double alive = 0.0;
  for (const GridRobot& r : robots) alive += !r.fell;
  return alive / static_cast<double>(robots.size());
}

// Mean over the cells that are not nan.
template <typename Of>
double mean_over(std::size_t count, const Of& of) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = of(i);
  return mean_of(values);
}

RunGroup cells_group(const std::vector<GridCell>& cells, const Cells& runs,
                     const sim::Robot& robot) {
  RunGroup group{kGround, "cells", 0.0, {}, {}};
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const std::vector<GridRobot>& robots = runs[c];
    const double success = success_of(robots);
    const auto put = [&](const char* name, double value) { group.lists[name].push_back(value); };
    put("sigma_flat_npm3", cells[c].sigma_flat_npm3);
    put("sigma_cone_npm3", cells[c].sigma_cone_npm3);
    put("static_depth_m", static_depth_m(robot, cells[c]));
    put("success", success);
    put("reward", mean_over(robots.size(), [&](std::size_t i) { return robots[i].reward; }));
    put("clearance_m",
        success > kLeastSuccess
            ? mean_over(robots.size(), [&](std::size_t i) { return robots[i].clearance_m; })
            : kNan);
  }
  return group;
}

RunGroup robots_group(const std::vector<GridCell>& cells, const Cells& runs) {
  RunGroup group{kGround, "robots", 0.0, {}, {}};
  std::vector<double> log_flat, log_cone;
  for (const GridCell& cell : cells) {
    log_flat.push_back(std::log10(cell.sigma_flat_npm3));
    log_cone.push_back(std::log10(cell.sigma_cone_npm3));
  }
  for (std::size_t i = 0; i < runs[0].size(); ++i) {
    const auto mean = [&](auto of) {
      return mean_over(cells.size(), [&](std::size_t c) { return of(runs[c][i]); });
    };
    group.runs["reward"].push_back(mean([](const GridRobot& r) { return r.reward; }));
    group.runs["success"].push_back(mean([](const GridRobot& r) { return r.fell ? 0.0 : 1.0; }));
    std::vector<double> clearance;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const bool black = success_of(runs[c]) <= kLeastSuccess;
      clearance.push_back(black ? kNan : runs[c][i].clearance_m);
    }
    const Slopes slopes = fit_slopes(log_flat, log_cone, clearance);
    group.runs["slope_flat_m"].push_back(slopes.a);
    group.runs["slope_cone_m"].push_back(slopes.b);
  }
  return group;
}

RunGroup terms_group(const Cells& runs) {
  RunGroup group{kGround, "terms", 0.0, {}, {}};
  const std::vector<std::string> names = train::reward_term_names();
  for (std::size_t term = 0; term < names.size(); ++term) {
    group.lists[names[term]] = {mean_over(runs.size(), [&](std::size_t c) {
      return mean_over(runs[c].size(),
                       [&](std::size_t i) { return runs[c][i].reward_terms[term]; });
    })};
  }
  return group;
}

}  // namespace

Measured run_grid(Lab& lab, const Model& model) {
  const LabSettings& settings = lab.settings();
  WorkerPool pool(settings.threads);
  const std::vector<GridCell> cells = grid_cells(settings.grid_cells);
  Cells runs;
  for (const GridCell& cell : cells) {
    runs.push_back(run_cell(model.network, cell, settings.grid_runs, lab.robot(), pool));
  }
  return {{cells_group(cells, runs, lab.robot()), robots_group(cells, runs), terms_group(runs)}};
}

}  // namespace sandrunner::study
