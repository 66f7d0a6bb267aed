// SPDX-License-Identifier: BSD-3-Clause
#include "rt/report/run_statistics.h"

#include <algorithm>
#include <cmath>

#include "rt/base/quantile.h"
#include "rt/report/body_motion.h"

namespace sandrunner {
namespace {

constexpr int kShortestStance_ticks = kControlHz / 100;  // 10 ms
constexpr double kLift_m = 0.001;

double square(double v) { return v * v; }

}  // namespace

void RunStatistics::add(const TickRecord& tick, const StateEstimate* truth) {
  const GateCounters before = counters_;
  counters_ = tick.counters;
  if (tick.counts == 0) return;
  if (periods_.empty() || periods_.back().ticks == kTicksPerPolicyStep) periods_.emplace_back();
  Period& p = periods_.back();
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
  const JointState& sensed = tick.input.sensors.joints;
  const JointArray<double>& torque_nm = p.has_truth ? robot.joint_torque_nm : sensed.torque_nm;
  const JointArray<double>& velocity_radps =
      p.has_truth ? tick.before.joint_velocity_radps : sensed.velocity_radps;
  for (int j = 0; j < kNumJoints; ++j) {
    p.power += torque_nm[j] * velocity_radps[j];
    p.torque_squared += square(torque_nm[j]);
  }
  p.command = tick.output.policy_input.command;
  p.past_stop += static_cast<int>(counters_.joint_past_stop - before.joint_past_stop);
  p.too_fast += static_cast<int>(counters_.joint_too_fast - before.joint_too_fast);
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
  if (p.has_truth && p.ticks == kTicksPerPolicyStep) {
    for (int l = 0; l < kNumLegs; ++l) {
      p.foot_height[l] = robot.state.foot_height_m[l] - robot.position_m[2];
    }
  }
  if (p.has_truth) follow_stances(tick);
}

void RunStatistics::follow_stances(const TickRecord& tick) {
  for (int l = 0; l < kNumLegs; ++l) {
    Stance& stance = stances_[l];
    const double depth = tick.truth.foot_penetration_m[l];
    if (!stance.open && depth >= 0.0) stance = {.open = true};
    if (!stance.open) continue;
    ++stance.ticks;
    if (depth > stance.depth) {
      stance.depth = depth;
      stance.x = tick.truth.foot_centre_m[l][0];
      stance.y = tick.truth.foot_centre_m[l][1];
    }
    if (depth > -kLift_m) continue;
    stance.open = false;
    if (stance.ticks < kShortestStance_ticks) continue;
    ended_.push_back({periods_.size() - 1, stance.depth});
    footprints_.push_back({static_cast<double>(tick.input.sensors.tick + 1) * kControlPeriod_s,
                           stance.x, stance.y, stance.depth});
  }
}

double RunStatistics::time_s() const noexcept {
  std::int64_t ticks = 0;
  for (const Period& p : periods_) ticks += p.ticks;
  return static_cast<double>(ticks) * kControlPeriod_s;
}

RunFigures RunStatistics::figures(double mass_kg, double motor_constant) const {
  RunFigures f;
  const std::size_t begin = periods_.size() / 2;
  Period sum;
  double command_ticks = 0.0;
  for (std::size_t i = begin; i < periods_.size(); ++i) {
    const Period& p = periods_[i];
    sum.has_truth = p.has_truth;
    sum.ticks += p.ticks;
    sum.estimates += p.estimates;
    sum.vx += p.vx;
    sum.vy += p.vy;
    sum.yaw_rate += p.yaw_rate;
    sum.power += p.power;
    sum.torque_squared += p.torque_squared;
    sum.velocity_error2 += p.velocity_error2;
    sum.height_error2 += p.height_error2;
    sum.foot_error2 += p.foot_error2;
    sum.past_stop += p.past_stop;
    sum.too_fast += p.too_fast;
    f.mean_command_mps[0] += p.command.vx_mps;
    f.mean_command_mps[1] += p.command.vy_mps;
    f.mean_yaw_command_radps += p.command.wz_radps;
    command_ticks += 1.0;
  }
  if (sum.ticks == 0) return f;
  const double n = sum.ticks;
  for (double& v : f.mean_command_mps) v /= command_ticks;
  f.mean_yaw_command_radps /= command_ticks;
  f.mechanical_power_w = sum.power / n;
  f.torque_squared_nm2 = sum.torque_squared / n;
  f.joint_limit_steps = sum.past_stop;
  f.speed_limit_steps = sum.too_fast;
  if (sum.estimates > 0) {
    f.estimate = {.velocity_rmse_mps = std::sqrt(sum.velocity_error2 / sum.estimates),
                  .body_height_rmse_m = std::sqrt(sum.height_error2 / sum.estimates),
                  .foot_height_rmse_m = std::sqrt(sum.foot_error2 / sum.estimates)};
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
  for (const EndedStance& stance : ended_) {
    if (stance.period < begin) continue;
    ++m.stances;
    m.sinkage_mean_m += stance.depth;
    m.sinkage_max_m = std::max(m.sinkage_max_m, stance.depth);
  }
  if (m.stances > 0) m.sinkage_mean_m /= m.stances;
  return f;
}

double RunStatistics::foot_clearance_iqr_m(std::size_t begin) const {
  double iqr_m = 0.0;
  for (int l = 0; l < kNumLegs; ++l) {
    std::vector<double> heights;
    for (std::size_t i = begin; i < periods_.size(); ++i) {
      if (periods_[i].ticks == kTicksPerPolicyStep) heights.push_back(periods_[i].foot_height[l]);
    }
    if (heights.empty()) continue;
    std::sort(heights.begin(), heights.end());
    iqr_m += (quantile(heights, 0.75) - quantile(heights, 0.25)) / kNumLegs;
  }
  return iqr_m;
}

}  // namespace sandrunner
