// SPDX-License-Identifier: BSD-3-Clause
// The paper's Fig. 4 A to D: how a network walks on soils of a grid of stiffnesses.
#pragma once

#include <array>
#include <vector>

#include "tools/study/simulated/plain_task.h"
#include "tools/study/simulated/task_run.h"
#include "tools/train/task/reward.h"

namespace sandrunner::study {

/// The paper's grid, or a coarser one of the same extent: sigma_flat of 1 to 10 MN/m^3 times
/// sigma_cone of 0.15 to 0.6 MN/m^3, `each_way` >= 2 equally spaced values of each. sigma_cone
/// changes from one cell to the next.
std::vector<GridCell> grid_cells(int each_way);

/// What a robot did in 4 s.
struct GridRobot {
  bool fell = false;
  double reward = 0.0;  ///< mean of a step, in the units of training.toml; none after a fall
  /// Likewise, of each of train::reward_term_names(). Their sum is less than the reward where the
  /// floor of the penalties holds, and a diverged robot's last step has none.
  std::array<double, train::kRewardTerms> reward_terms{};
  /// Mean height of the feet above the mean depth of their stances, m; nan if it fell or had no
  /// stance.
  double clearance_m = 0.0;
};

/// Adds up what makes the clearance: each foot's height, and the deepest point of each stance.
class ClearanceSums {
 public:
  /// A step: heights of the feet's lowest points above the undisturbed ground, m, and which feet
  /// are loaded.
  void add(const std::array<double, kNumLegs>& height_m, const std::array<bool, kNumLegs>& loaded);
  /// nan without a stance. A stance that lasts counts as far as it got.
  double clearance_m() const;

 private:
  double height_sum_m_ = 0.0;
  int heights_ = 0;
  std::array<double, kNumLegs> deepest_m_{};  // of the stance so far
  double depth_sum_m_ = 0.0;                  // of those that are over
  int stances_ = 0;
};

/// y = constant + a_slope a + b_slope b, by least squares over the points whose y is not nan.
struct Slopes {
  double a = 0.0, b = 0.0;  ///< nan if the points don't tell them
};
Slopes fit_slopes(const std::vector<double>& a, const std::vector<double>& b,
                  const std::vector<double>& y);

/// Runs `robots` robots; each has the same start and command in every cell and for every network.
std::vector<GridRobot> run_cell(const train::TaskNetwork& network, const GridCell& cell, int robots,
                                const sim::Robot& robot, WorkerPool& pool);

}  // namespace sandrunner::study
