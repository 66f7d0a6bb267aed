// SPDX-License-Identifier: BSD-3-Clause
#include "rt/report/run_statistics.h"

#include <algorithm>
#include <cmath>

#include "rt/base/quantile.h"
#include "rt/report/body_motion.h"
#include "rt/report/joint_power.h"

namespace sandrunner {
namespace {

constexpr std::size_t kMostPeriods = 1 << 16;     // 11 minutes; 10 MB
constexpr std::size_t kMostFootprints = 1 << 16;  // 2 MB

double square(double v) { return v * v; }

}  // namespace

void RunStatistics::add(const TickRecord& tick, const StateEstimate* truth) {
  const GateCounters before = counters_;
  counters_ = tick.counters;
  if (tick.counts == 0) return;
  Period& p = present_;
  ++p.ticks;
  p.has_truth = tick.has_truth != 0;
  const RobotTruth& robot = tick.truth;
  if (p.has_truth) {
    const BodyMotion motion =
        body_motion(robot.orientation_wxyz, robot.velocity_mps, robot.angular_velocity_radps);
    p.vx += motion.vx_mps;
    p.vy += motion.vy_mps;
    p.yaw_rate += motion.yaw_rate_radps;
  }
  const JointPower power = joint_power(tick);
  p.power += power.mechanical_w;
  p.torque_squared += power.torque_squared_nm2;
  p.command = tick.output.policy_input.command;
  p.past_stop += static_cast<std::int64_t>(counters_.joint_past_stop - before.joint_past_stop);
  p.too_fast += static_cast<std::int64_t>(counters_.joint_too_fast - before.joint_too_fast);
  if (truth) {
    const StateEstimate& estimate = tick.input.policy.estimate;
    ++p.estimates;
    for (int i = 0; i < 3; ++i) {
      p.velocity_error2 += square(estimate.velocity_mps[i] - truth->velocity_mps[i]);
    }
    p.height_error2 += square(estimate.body_height_m - truth->body_height_m);
    for (int l = 0; l < kNumLegs; ++l) {
      p.foot_error2 += square(estimate.foot_height_m[l] - truth->foot_height_m[l]) / kNumLegs;
    }
  }
  if (p.has_truth) {
    stances_.add(tick, [&](std::size_t, double time_s, const Stance& stance) {
      const auto [x_m, y_m, depth_m] = stance.deepest_m;
      ++p.stances;
      p.sinkage += depth_m;
      p.sinkage_max = std::max(p.sinkage_max, depth_m);
      if (footprints_.size() == kMostFootprints) footprints_.pop_front();
      footprints_.push_back({time_s, x_m, y_m, depth_m});
    });
  }
  if (p.ticks < kTicksPerPolicyStep) return;
  for (int l = 0; l < kNumLegs; ++l) {
    p.foot_height[l] = robot.state.foot_height_m[l] - robot.position_m[2];
  }
  end_period();
}

void RunStatistics::Period::add(const Period& next) noexcept {
  periods += next.periods;
  ticks += next.ticks;
  estimates += next.estimates;
  has_truth = next.has_truth;
  vx += next.vx;
  vy += next.vy;
  yaw_rate += next.yaw_rate;
  power += next.power;
  torque_squared += next.torque_squared;
  command.vx_mps += next.command.vx_mps;
  command.vy_mps += next.command.vy_mps;
  command.wz_radps += next.command.wz_radps;
  velocity_error2 += next.velocity_error2;
  height_error2 += next.height_error2;
  foot_error2 += next.foot_error2;
  past_stop += next.past_stop;
  too_fast += next.too_fast;
  stances += next.stances;
  sinkage += next.sinkage;
  sinkage_max = std::max(sinkage_max, next.sinkage_max);
  foot_height = next.foot_height;
}

void RunStatistics::end_period() {
  if (!periods_.empty() && periods_.back().periods < periods_each_) {
    periods_.back().add(present_);
  } else {
    periods_.push_back(present_);
  }
  present_ = {};
  if (periods_.size() < kMostPeriods || periods_.back().periods < periods_each_) return;
  for (std::size_t i = 0; i < kMostPeriods / 2; ++i) {
    periods_[i] = periods_[2 * i];
    periods_[i].add(periods_[2 * i + 1]);
  }
  periods_.resize(kMostPeriods / 2);
  periods_each_ *= 2;
}

double RunStatistics::time_s() const noexcept {
  std::int64_t ticks = present_.ticks;
  for (const Period& p : periods_) ticks += p.ticks;
  return static_cast<double>(ticks) * kControlPeriod_s;
}

RunFigures RunStatistics::figures(double mass_kg, double motor_constant) const {
  RunFigures f;
  const bool begun = present_.ticks > 0;
  const std::size_t begin = (periods_.size() + (begun ? 1 : 0)) / 2;
  Period sum;
  sum.periods = 0;
  for (std::size_t i = begin; i < periods_.size(); ++i) sum.add(periods_[i]);
  if (begun) sum.add(present_);
  if (sum.ticks == 0) return f;
  const auto n = static_cast<double>(sum.ticks), periods = static_cast<double>(sum.periods);
  f.mean_command_mps = {sum.command.vx_mps / periods, sum.command.vy_mps / periods};
  f.mean_yaw_command_radps = sum.command.wz_radps / periods;
  f.mechanical_power_w = sum.power / n;
  f.torque_squared_nm2 = sum.torque_squared / n;
  f.joint_limit_steps = sum.past_stop;
  f.speed_limit_steps = sum.too_fast;
  if (sum.estimates > 0) {
    const auto estimates = static_cast<double>(sum.estimates);
    f.estimate = {.velocity_rmse_mps = std::sqrt(sum.velocity_error2 / estimates),
                  .body_height_rmse_m = std::sqrt(sum.height_error2 / estimates),
                  .foot_height_rmse_m = std::sqrt(sum.foot_error2 / estimates)};
  }
  if (!sum.has_truth) return f;
  MotionFigures& m = f.motion.emplace();
  m.mean_velocity_mps = {sum.vx / n, sum.vy / n};
  m.mean_yaw_rate_radps = sum.yaw_rate / n;
  const double speed = std::fabs(m.mean_velocity_mps[0]);
  if (speed >= 0.05) {
    m.cost_of_transport = (f.mechanical_power_w + f.torque_squared_nm2 / square(motor_constant)) /
                          (mass_kg * kGravity_mps2 * speed);
  }
  m.foot_clearance_iqr_m = foot_clearance_iqr_m(begin);
  m.stances = sum.stances;
  m.sinkage_max_m = sum.sinkage_max;
  if (sum.stances > 0) m.sinkage_mean_m = sum.sinkage / sum.stances;
  return f;
}

double RunStatistics::foot_clearance_iqr_m(std::size_t begin) const {
  double iqr_m = 0.0;
  for (int l = 0; l < kNumLegs; ++l) {
    std::vector<double> heights;
    for (std::size_t i = begin; i < periods_.size(); ++i) {
      heights.push_back(periods_[i].foot_height[l]);
    }
    if (heights.empty()) continue;
    std::sort(heights.begin(), heights.end());
    iqr_m += (quantile(heights, 0.75) - quantile(heights, 0.25)) / kNumLegs;
  }
  return iqr_m;
}

}  // namespace sandrunner
