// SPDX-License-Identifier: BSD-3-Clause
#include "rt/report/run_statistics.h"

#include <algorithm>
#include <cmath>

#include "rt/base/quantile.h"

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
  const RobotTruth& robot = tick.truth;
  const auto& q = robot.orientation_wxyz;
  const sim::Mat3<double> r =
      sim::rotation_matrix(sim::Quaternion<double>{q[0], q[1], q[2], q[3]});
  const double forward = std::sqrt(r.r0.x * r.r0.x + r.r1.x * r.r1.x);
  const double c = r.r0.x / forward, s = r.r1.x / forward;
  const auto& v = robot.velocity_mps;
  p.vx += c * v[0] + s * v[1];
  p.vy += c * v[1] - s * v[0];
  const auto& w = robot.angular_velocity_radps;
  p.yaw_rate += dot(r.r2, sim::Vec3<double>{w[0], w[1], w[2]});
  for (int j = 0; j < kNumJoints; ++j) {
    p.power += robot.joint_torque_nm[j] * tick.before.joint_velocity_radps[j];
    p.torque_squared += square(robot.joint_torque_nm[j]);
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
  if (p.ticks == kTicksPerPolicyStep) {
    for (int l = 0; l < kNumLegs; ++l) {
      p.foot_height[l] = robot.state.foot_height_m[l] - robot.position_m[2];
    }
  }
  follow_stances(tick);
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
  std::array<std::vector<double>, kNumLegs> heights;
  double command_ticks = 0.0;
  for (std::size_t i = begin; i < periods_.size(); ++i) {
    const Period& p = periods_[i];
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
    if (p.ticks == kTicksPerPolicyStep) {
      for (int l = 0; l < kNumLegs; ++l) heights[l].push_back(p.foot_height[l]);
    }
  }
  if (sum.ticks == 0) return f;
  const double n = sum.ticks;
  f.mean_velocity_mps = {sum.vx / n, sum.vy / n};
  f.mean_yaw_rate_radps = sum.yaw_rate / n;
  for (double& v : f.mean_command_mps) v /= command_ticks;
  f.mean_yaw_command_radps /= command_ticks;
  f.mechanical_power_w = sum.power / n;
  f.torque_squared_nm2 = sum.torque_squared / n;
  const double speed = std::fabs(f.mean_velocity_mps[0]);
  if (speed >= 0.05) {
    f.cost_of_transport = (f.mechanical_power_w + f.torque_squared_nm2 / square(motor_constant)) /
                          (mass_kg * sim::kGravity_mps2 * speed);
  }
  f.joint_limit_steps = sum.past_stop;
  f.speed_limit_steps = sum.too_fast;
  if (sum.estimates > 0) {
    f.has_estimate = true;
    f.velocity_rmse_mps = std::sqrt(sum.velocity_error2 / sum.estimates);
    f.body_height_rmse_m = std::sqrt(sum.height_error2 / sum.estimates);
    f.foot_height_rmse_m = std::sqrt(sum.foot_error2 / sum.estimates);
  }
  for (auto& h : heights) {
    if (h.empty()) continue;
    std::sort(h.begin(), h.end());
    f.foot_clearance_iqr_m += (quantile(h, 0.75) - quantile(h, 0.25)) / kNumLegs;
  }
  for (const EndedStance& stance : ended_) {
    if (stance.period < begin) continue;
    ++f.stances;
    f.sinkage_mean_m += stance.depth;
    f.sinkage_max_m = std::max(f.sinkage_max_m, stance.depth);
  }
  if (f.stances > 0) f.sinkage_mean_m /= f.stances;
  return f;
}

}  // namespace sandrunner
