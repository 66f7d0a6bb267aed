// SPDX-License-Identifier: BSD-3-Clause
#include "rt/report/row_maker.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "estimator/cost_of_transport.h"
#include "rt/report/body_motion.h"

namespace sandrunner {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

template <std::size_t kSize>
std::array<float, kSize> floats(const std::array<double, kSize>& from) {
  std::array<float, kSize> to;
  for (std::size_t i = 0; i < kSize; ++i) to[i] = static_cast<float>(from[i]);
  return to;
}

std::array<float, 3> floats(const VelocityCommand& c) {
  return floats(std::array{c.vx_mps, c.vy_mps, c.wz_radps});
}

std::array<float, 8> floats(const StateEstimate& e) {
  return floats(std::array{e.body_height_m, e.velocity_mps[0], e.velocity_mps[1], e.velocity_mps[2],
                           e.foot_height_m[0], e.foot_height_m[1], e.foot_height_m[2],
                           e.foot_height_m[3]});
}

float micro(std::int64_t ns) { return 1e-3f * static_cast<float>(ns); }

// Without truth only the yaw rate is known.
std::array<double, 3> motion_of(const TickRecord& tick) {
  if (tick.has_truth != 0) {
    const RobotTruth& now = tick.truth;
    const BodyMotion motion =
        body_motion(now.orientation_wxyz, now.velocity_mps, now.angular_velocity_radps);
    return {motion.vx_mps, motion.vy_mps, motion.yaw_rate_radps};
  }
  const ImuSample& imu = tick.input.sensors.imu;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  return {kNone, kNone,
          body_motion(imu.orientation_wxyz, {}, imu.angular_velocity_radps).yaw_rate_radps};
}

}  // namespace

void RowMaker::follow(const TickRecord& tick) {
  odometry_.add(tick.input, tick.output);
  if (tick.has_truth != 0) {
    stances_.add(tick, [&](std::size_t leg, double time_s, const Stance& stance) {
      footprints_.push_back({.t_s = time_s,
                             .x_m = stance.deepest_m[0],
                             .y_m = stance.deepest_m[1],
                             .depth_m = static_cast<float>(stance.deepest_m[2]),
                             .leg = static_cast<std::uint32_t>(leg)});
    });
  }
  ++sums_.ticks;
  sums_.counted += tick.counts != 0 ? 1 : 0;
  const JointPower power = joint_power(tick, heat_factor_);
  sums_.power.mechanical_w += power.mechanical_w;
  sums_.power.torque_squared_nm2 += power.torque_squared_nm2;
  const std::array<double, 3> motion = motion_of(tick);
  for (std::size_t k = 0; k < 3; ++k) sums_.motion[k] += motion[k];
  const JointArray<double>& torque = torque_of(tick);
  for (std::size_t j = 0; j < kNumJoints; ++j) {
    double& peak = sums_.peak_torque_nm[j];
    if (std::abs(torque[j]) > std::abs(peak)) peak = torque[j];
  }
  const TickTiming& t = tick.timing;
  sums_.worst.late_ns = std::max(sums_.worst.late_ns, t.late_ns);
  sums_.worst.control_ns = std::max(sums_.worst.control_ns, t.control_ns);
  sums_.worst_tick_ns = std::max(sums_.worst_tick_ns, t.read_ns + t.control_ns + t.write_ns);
  skipped_ += static_cast<std::uint32_t>(tick.skipped);
}

float RowMaker::cost_of_transport(const Effort& newest) {
  last_second_.push_back(newest);
  if (last_second_.size() > kPolicyHz) last_second_.pop_front();
  if (last_second_.size() < kPolicyHz) return kUnknown;
  Effort mean;
  for (const Effort& e : last_second_) {
    mean.power.mechanical_w += e.power.mechanical_w / kPolicyHz;
    mean.power.torque_squared_nm2 += e.power.torque_squared_nm2 / kPolicyHz;
    mean.vx_mps += e.vx_mps / kPolicyHz;
    mean.vy_mps += e.vy_mps / kPolicyHz;
  }
  const auto cost = sandrunner::cost_of_transport(
      mean.power.mechanical_w, mean.power.torque_squared_nm2, std::hypot(mean.vx_mps, mean.vy_mps),
      {.mass_kg = scene_.mass_kg, .motor_constant = scene_.motor_constant[0]});
  return cost ? static_cast<float>(*cost) : kUnknown;
}

RunRow RowMaker::make_row(const TickRecord& tick) {
  const SensorFrame& sensors = tick.input.sensors;
  const bool truth = tick.has_truth != 0;
  const Sums sums = std::exchange(sums_, {});
  const double share = 1.0 / sums.ticks;
  const JointPower power = {.mechanical_w = share * sums.power.mechanical_w,
                            .torque_squared_nm2 = share * sums.power.torque_squared_nm2};
  const auto [w, x, y, z] = odometry_.orientation_wxyz();
  RunRow row;
  row.t_s = static_cast<double>(sensors.tick) * kControlPeriod_s;
  row.mode = static_cast<std::uint32_t>(tick.output.mode);
  row.given = floats(tick.output.policy_input.command);
  row.requested = floats(tick.input.command.velocity);
  row.odometry = {odometry_.position_m()[0], odometry_.position_m()[1],
                  std::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))};
  row.motion = floats(motion_of(tick));
  for (std::size_t k = 0; k < 3; ++k) {
    row.mean_motion[k] = static_cast<float>(share * sums.motion[k]);
  }
  row.torque_nm = floats(torque_of(tick));
  row.peak_torque_nm = floats(sums.peak_torque_nm);
  row.estimate.fill(kUnknown);
  row.power_w = static_cast<float>(power.mechanical_w);
  row.torque_squared_nm2 = static_cast<float>(power.torque_squared_nm2);
  row.cost_of_transport =
      cost_of_transport({power, share * sums.motion[0], share * sums.motion[1]});
  row.late_us = micro(sums.worst.late_ns);
  row.control_us = micro(sums.worst.control_ns);
  row.tick_us = micro(sums.worst_tick_ns);
  row.joint_past_stop = static_cast<std::uint32_t>(tick.counters.joint_past_stop);
  row.joint_too_fast = static_cast<std::uint32_t>(tick.counters.joint_too_fast);
  row.faults = static_cast<std::uint32_t>(tick.output.faults);
  row.warnings = static_cast<std::uint32_t>(tick.output.warnings);
  row.flags = (truth ? kRowHasTruth : 0) | (sums.counted == sums.ticks ? kRowCounts : 0);
  row.skipped = skipped_;
  const Vector3& position_m = truth ? tick.truth.position_m : odometry_.position_m();
  const Rotation& orientation = truth ? tick.truth.orientation_wxyz : odometry_.orientation_wxyz();
  const JointArray<double>& joints_rad =
      truth ? tick.truth.joint_position_rad : sensors.joints.position_rad;
  row.position_m = position_m;
  row.orientation_wxyz = floats(orientation);
  row.position_rad = floats(joints_rad);
  row.velocity_radps =
      floats(truth ? tick.truth.joint_velocity_radps : sensors.joints.velocity_radps);
  kinematics_.place({position_m, orientation}, joints_rad);
  const std::array<LegPoints, kNumLegs> legs = kinematics_.legs();
  for (std::size_t l = 0; l < kNumLegs; ++l) {
    row.hip_m[l] = floats(legs[l].hip);
    row.knee_m[l] = floats(legs[l].knee);
    row.foot_m[l] = floats(legs[l].foot);
  }
  set_truth(tick, row);
  return row;
}

void RowMaker::set_truth(const TickRecord& tick, RunRow& row) const {
  if (tick.has_truth == 0) {
    for (auto* values : {&row.penetration_m, &row.ground_height_m, &row.contact}) {
      values->fill(kUnknown);
    }
    for (auto& force : row.foot_force_n) force.fill(kUnknown);
    for (auto& stance : row.stance_m) stance.fill(kUnknown);
    row.truth.fill(kUnknown);
    return;
  }
  row.penetration_m = floats(tick.truth.foot_penetration_m);
  row.truth = floats(tick.before.state);
  for (std::size_t l = 0; l < kNumLegs; ++l) {
    const auto& foot_m = row.foot_m[l];
    row.ground_height_m[l] = static_cast<float>(scene_.ground_height_m(foot_m[0], foot_m[1]));
    row.contact[l] = tick.truth.foot_penetration_m[l] >= 0.0 ? 1.0f : 0.0f;
    row.foot_force_n[l] = floats(tick.truth.foot_force_n[l]);
    row.stance_m[l] = floats(stances_.stances()[l].deepest_m);
  }
}

std::optional<RunRow> RowMaker::add(const TickRecord& tick) {
  follow(tick);
  std::optional<RunRow> complete;
  const PolicyOutput& policy = tick.input.policy;
  if (waiting_ && policy.sequence != policy_sequence_ && policy.input_tick == waiting_tick_) {
    waiting_->estimate = floats(policy.estimate);
    waiting_->flags |= kRowHasEstimate;
    complete = std::exchange(waiting_, std::nullopt);
  }
  policy_sequence_ = policy.sequence;
  if (!rate_.due(tick.input.sensors.tick)) return complete;
  if (waiting_) complete = waiting_;
  waiting_ = make_row(tick);
  waiting_tick_ = tick.input.sensors.tick;
  return complete;
}

std::optional<RunRow> RowMaker::take_last() { return std::exchange(waiting_, std::nullopt); }

std::vector<Footprint> RowMaker::take_footprints() { return std::exchange(footprints_, {}); }

}  // namespace sandrunner
