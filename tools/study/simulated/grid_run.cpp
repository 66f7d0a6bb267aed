// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/simulated/grid_run.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace sandrunner::study {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr int kBlock = 16, kSteps = 4 * kPolicyHz;
constexpr std::uint64_t kSeed = 7;  // of starts and commands

struct RobotSums {
  bool fell = false;
  double reward = 0.0;
  std::array<double, train::kRewardTerms> terms{};
  ClearanceSums clearance;
};

// Before the step, of the robot in this environment.
void add_feet(const TaskStep& s, int env, double foot_radius_m, ClearanceSums& sums) {
  const train::InputScales& scales = s.task.scales();
  constexpr int kFirstFoot = kEstimateSize - kNumLegs;
  constexpr int kFirstLoad = kTerrainSize + kEstimateSize;
  std::array<double, kNumLegs> height_m{};
  std::array<bool, kNumLegs> loaded{};
  for (int l = 0; l < kNumLegs; ++l) {
    const double centre_m = scales.estimate_mean[kFirstFoot + l] +
                            scales.estimate_deviation[kFirstFoot + l] *
                                s.rollout.estimate_target(0)(kFirstFoot + l, env);
    height_m[l] = centre_m - foot_radius_m;
    loaded[l] = s.rollout.insight(0)(kFirstLoad + l, env) > 0.5f;
  }
  sums.add(height_m, loaded);
}

}  // namespace

std::vector<GridCell> grid_cells(int each_way) {
  const auto at = [&](double low, double high, int i) {
    return low + (high - low) * i / (each_way - 1);
  };
  std::vector<GridCell> cells;
  for (int flat = 0; flat < each_way; ++flat) {
    for (int cone = 0; cone < each_way; ++cone) {
      cells.push_back({at(1.0e6, 10.0e6, flat), at(0.15e6, 0.6e6, cone)});
    }
  }
  return cells;
}

void ClearanceSums::add(const std::array<double, kNumLegs>& height_m,
                        const std::array<bool, kNumLegs>& loaded) {
  for (int l = 0; l < kNumLegs; ++l) {
    height_sum_m_ += height_m[l];
    ++heights_;
    if (loaded[l]) deepest_m_[l] = std::max(deepest_m_[l], -height_m[l]);
    if (loaded[l] || deepest_m_[l] == 0.0) continue;
    depth_sum_m_ += deepest_m_[l];
    ++stances_;
    deepest_m_[l] = 0.0;
  }
}

double ClearanceSums::clearance_m() const {
  double depth_sum_m = depth_sum_m_;
  int stances = stances_;
  for (const double depth_m : deepest_m_) {
    depth_sum_m += depth_m;
    stances += depth_m > 0.0;
  }
  if (stances == 0) return kNan;
  return height_sum_m_ / heights_ + depth_sum_m / stances;
}

Slopes fit_slopes(const std::vector<double>& a, const std::vector<double>& b,
                  const std::vector<double>& y) {
  double n = 0.0, mean_a = 0.0, mean_b = 0.0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    if (std::isnan(y[i])) continue;
    n += 1.0;
    mean_a += a[i];
    mean_b += b[i];
  }
  mean_a /= n;
  mean_b /= n;
  double aa = 0.0, bb = 0.0, ab = 0.0, ay = 0.0, by = 0.0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    if (std::isnan(y[i])) continue;
    const double da = a[i] - mean_a, db = b[i] - mean_b;
    aa += da * da;
    bb += db * db;
    ab += da * db;
    ay += da * y[i];
    by += db * y[i];
  }
  const double determinant = aa * bb - ab * ab;
  // Also without a point, as nan.
  if (!(determinant > 1e-9 * aa * bb)) return {kNan, kNan};
  return {(ay * bb - by * ab) / determinant, (by * aa - ay * ab) / determinant};
}

std::vector<GridRobot> run_cell(const train::TaskNetwork& network, const GridCell& cell, int robots,
                                const sim::Robot& robot, WorkerPool& pool) {
  TaskRun run{grid_task(robot, cell)};
  run.envs = (robots + kBlock - 1) / kBlock * kBlock;
  run.block_envs = kBlock;
  run.steps = kSteps;
  run.seed = kSeed;
  std::vector<RobotSums> sums(static_cast<std::size_t>(run.envs));
  run_on_task(network, run, robot, pool, [&](const TaskStep& s) {
    for (int env = s.first_env; env < s.first_env + s.envs; ++env) {
      RobotSums& one = sums[static_cast<std::size_t>(env)];
      if (one.fell) continue;
      add_feet(s, env, robot.model.foot_radius_m, one.clearance);
      one.reward += s.rollout.reward(0, env);
      const auto& terms = s.details.terms[static_cast<std::size_t>(env)];
      for (std::size_t i = 0; i < terms.size(); ++i) one.terms[i] += terms[i];
      one.fell = s.rollout.end(0, env) == learner::End::kTerminated;
    }
  });
  std::vector<GridRobot> result;
  for (int i = 0; i < robots; ++i) {
    const RobotSums& one = sums[static_cast<std::size_t>(i)];
    result.push_back({one.fell, one.reward / (run.task.reward.scale * kSteps), one.terms,
                      one.fell ? kNan : one.clearance.clearance_m()});
    for (double& term : result.back().reward_terms) term /= kSteps;
  }
  return result;
}

}  // namespace sandrunner::study
