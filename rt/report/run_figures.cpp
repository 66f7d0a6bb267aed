// SPDX-License-Identifier: BSD-3-Clause
#include "rt/report/run_figures.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "estimator/cost_of_transport.h"
#include "rt/base/quantile.h"

namespace sandrunner {
namespace {

double square(double v) { return v * v; }

bool has(const RunRow& row, std::uint32_t flag) { return (row.flags & flag) != 0; }

/// Indices of the rows that the figures are of.
std::vector<std::size_t> steady_rows(const RunRecord& record) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < record.rows.size(); ++i) {
    if (has(record.rows[i], kRowCounts)) rows.push_back(i);
  }
  rows.erase(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(rows.size() / 2));
  return rows;
}

std::optional<EstimateErrors> estimate_errors(const RunRecord& record,
                                              const std::vector<std::size_t>& steady) {
  double count = 0.0, velocity2 = 0.0, height2 = 0.0, foot2 = 0.0;
  for (const std::size_t i : steady) {
    const RunRow& row = record.rows[i];
    if (!has(row, kRowHasEstimate) || !has(row, kRowHasTruth)) continue;
    const auto error2 = [&](std::size_t k) { return square(row.estimate[k] - row.truth[k]); };
    ++count;
    height2 += error2(0);
    for (std::size_t k = 1; k < 4; ++k) velocity2 += error2(k);
    for (std::size_t k = 4; k < 8; ++k) foot2 += error2(k) / kNumLegs;
  }
  if (count == 0.0) return std::nullopt;
  return EstimateErrors{.velocity_rmse_mps = std::sqrt(velocity2 / count),
                        .body_height_rmse_m = std::sqrt(height2 / count),
                        .foot_height_rmse_m = std::sqrt(foot2 / count)};
}

double foot_clearance_iqr_m(const RunRecord& record, const std::vector<std::size_t>& steady) {
  double iqr_m = 0.0;
  for (std::size_t l = 0; l < kNumLegs; ++l) {
    std::vector<double> heights;
    for (const std::size_t i : steady) {
      heights.push_back(record.rows[i].foot_m[l][2] - record.rows[i].position_m[2]);
    }
    std::sort(heights.begin(), heights.end());
    iqr_m += (quantile(heights, 0.75) - quantile(heights, 0.25)) / kNumLegs;
  }
  return iqr_m;
}

void add_stances(const RunRecord& record, const std::vector<std::size_t>& steady,
                 MotionFigures& m) {
  double sinkage_m = 0.0;
  for (const Footprint& print : record.footprints) {
    // A stance belongs to the first row that is not before its last tick.
    const auto row =
        std::ranges::lower_bound(record.rows, print.t_s - kControlPeriod_s, {}, &RunRow::t_s);
    const auto index = static_cast<std::size_t>(row - record.rows.begin());
    if (!std::ranges::binary_search(steady, index)) continue;
    ++m.stances;
    sinkage_m += print.depth_m;
    m.sinkage_max_m = std::max<double>(m.sinkage_max_m, print.depth_m);
  }
  if (m.stances > 0) m.sinkage_mean_m = sinkage_m / m.stances;
}

constexpr double kYawLength_m = 0.5;        // a yaw rate as a speed
constexpr double kLeastCommand_mps = 0.05;  // below it there is nothing to follow

}  // namespace

std::optional<double> RunFigures::followed() const noexcept {
  const std::array<double, 3> asked{mean_command_mps[0], mean_command_mps[1],
                                    kYawLength_m * mean_yaw_command_radps};
  const double asked2 = square(asked[0]) + square(asked[1]) + square(asked[2]);
  if (!motion || asked2 < square(kLeastCommand_mps)) return std::nullopt;
  const double done = asked[0] * motion->mean_velocity_mps[0] +
                      asked[1] * motion->mean_velocity_mps[1] +
                      asked[2] * kYawLength_m * motion->mean_yaw_rate_radps;
  return done / asked2;
}

RunFigures run_figures(const RunRecord& record) {
  RunFigures f;
  const std::vector<std::size_t> steady = steady_rows(record);
  if (steady.empty()) return f;
  const double share = 1.0 / static_cast<double>(steady.size());
  std::array<double, 3> motion{};
  for (const std::size_t i : steady) {
    const RunRow& row = record.rows[i];
    f.mean_command_mps[0] += share * row.given[0];
    f.mean_command_mps[1] += share * row.given[1];
    f.mean_yaw_command_radps += share * row.given[2];
    f.mechanical_power_w += share * row.power_w;
    f.torque_squared_nm2 += share * row.torque_squared_nm2;
    for (std::size_t k = 0; k < 3; ++k) motion[k] += share * row.mean_motion[k];
    const RunRow& before = i > 0 ? record.rows[i - 1] : RunRow{};
    f.joint_limit_steps += row.joint_past_stop - before.joint_past_stop;
    f.speed_limit_steps += row.joint_too_fast - before.joint_too_fast;
  }
  f.estimate = estimate_errors(record, steady);
  if (!has(record.rows[steady.back()], kRowHasTruth)) return f;
  MotionFigures& m = f.motion.emplace();
  m.mean_velocity_mps = {motion[0], motion[1]};
  m.mean_yaw_rate_radps = motion[2];
  m.cost_of_transport = cost_of_transport(
      f.mechanical_power_w, f.torque_squared_nm2,
      std::hypot(m.mean_velocity_mps[0], m.mean_velocity_mps[1]),
      {.mass_kg = record.scene.mass_kg, .motor_constant = record.scene.motor_constant[0]});
  m.foot_clearance_iqr_m = foot_clearance_iqr_m(record, steady);
  add_stances(record, steady, m);
  return f;
}

}  // namespace sandrunner
