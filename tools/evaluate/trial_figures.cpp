// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/trial_figures.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "estimator/cost_of_transport.h"
#include "estimator/heading.h"
#include "rt/base/add_members.h"
#include "rt/base/quantile.h"

namespace sandrunner::evaluate {
namespace {

constexpr double kStep_s = 1.0 / kPolicyHz;
// A lift-off takes two periods without a load.
using sim::kLoaded_n;
constexpr std::size_t kSettled = kPolicyHz;  // periods before the tracking errors count
constexpr double kUsualGaitCycle_s = 0.5;    // where no stride is seen
constexpr double kShortestGaitCycle_s = 0.2, kLongestGaitCycle_s = 1.0;

double square(double v) { return v * v; }
// As long on every machine: the last bit of std::hypot is not.
double length(double x, double y) { return std::sqrt(square(x) + square(y)); }

template <typename Range>
double loaded_share(const Range& load) {
  int loaded = 0;
  for (const float n : load) loaded += n > kLoaded_n;
  return static_cast<double>(loaded) / kNumLegs;
}

}  // namespace

void TrialRecorder::begin_period(const sim::RobotState<float>& state, const StateEstimate& truth,
                                 const StateEstimate& estimate, const VelocityCommand& command,
                                 const JointArray<double>& target_before,
                                 const JointArray<double>& target, double kp, double kd,
                                 const RobotFacts& facts) {
  const sim::RigidState<float>& x = state.rigid;
  const sim::Mat3<float> r = sim::rotation_matrix(x.orientation);
  Period p;
  p.distance = static_cast<float>(distance_m_);
  const Horizontal<float> velocity =
      components_along(heading_direction<float>({r.r0.x, r.r1.x}), {x.velocity.x, x.velocity.y});
  p.vx = velocity[0];
  p.vy = velocity[1];
  p.yaw_rate = dot(r.r2, x.angular_velocity);
  p.height = static_cast<float>(truth.body_height_m);
  p.tilt2 = static_cast<float>(square(std::acos(std::clamp(r.r2.z, -1.0f, 1.0f))));
  p.velocity_error = static_cast<float>(length(command.vx_mps - p.vx, command.vy_mps - p.vy));
  p.yaw_error = static_cast<float>(std::fabs(command.wz_radps - p.yaw_rate));
  double change2 = 0.0;
  bool at_limit = false;
  for (int j = 0; j < kNumJoints; ++j) {
    change2 += square(target[j] - target_before[j]);
    joint_speed_max_ = std::max(joint_speed_max_, std::fabs(static_cast<double>(x.qd[j])));
    at_limit =
        at_limit || std::fabs(kp * (target[j] - x.q[j]) - kd * x.qd[j]) > facts.torque_limit_nm[j];
  }
  torque_limit_steps_ += at_limit;
  p.action_change = static_cast<float>(std::sqrt(change2));
  double velocity2 = 0.0, foot2 = 0.0;
  for (int i = 0; i < 3; ++i) velocity2 += square(estimate.velocity_mps[i] - truth.velocity_mps[i]);
  for (int l = 0; l < kNumLegs; ++l) {
    foot2 += square(estimate.foot_height_m[l] - truth.foot_height_m[l]) / kNumLegs;
    p.foot_height[l] = static_cast<float>(truth.foot_height_m[l] - x.position.z);
  }
  p.estimate_velocity2 = static_cast<float>(velocity2);
  p.estimate_height2 = static_cast<float>(square(estimate.body_height_m - truth.body_height_m));
  p.estimate_foot2 = static_cast<float>(foot2);
  distance_m_ += p.vx * kStep_s;
  periods_.push_back(p);
}

void TrialRecorder::end_period(const sim::BatchSums<float>& sums) {
  constexpr float kPerTick = 1.0f / kTicksPerPolicyStep;
  Period& p = periods_.back();
  for (int l = 0; l < kNumLegs; ++l) p.load[l] = sums.foot_load[l] * kPerTick;
  p.power = sums.power * kPerTick;
  p.extension_power = sums.extension_power * kPerTick;
  p.torque2 = sums.torque_squared * kPerTick;
  p.too_fast = sums.ticks_too_fast * kPerTick;
  p.past_stop = sums.ticks_past_stop * kPerTick;
}

void TrialRecorder::steady_figures(const RobotFacts& facts, TrialFigures& f) const {
  const std::size_t begin = periods_.size() / 2, end = periods_.size();
  if (begin == end) return;
  Period sum;
  double duty = 0.0;
  int lift_offs = 0;
  std::array<std::vector<double>, kNumLegs> heights;
  for (std::size_t i = begin; i < end; ++i) {
    const Period& p = periods_[i];
    add_members<float>(p, sum);
    duty += loaded_share(p.load);
    for (int l = 0; l < kNumLegs; ++l) {
      heights[l].push_back(p.foot_height[l]);
      const auto loaded = [&](std::size_t k) { return periods_[k].load[l] > kLoaded_n; };
      lift_offs += i >= 2 && loaded(i - 2) && !loaded(i - 1) && !loaded(i);
    }
  }
  const double n = static_cast<double>(end - begin);
  f.vx_mps = sum.vx / n;
  f.vy_mps = sum.vy / n;
  f.yaw_rate_radps = sum.yaw_rate / n;
  f.horizontal_speed_mps = length(f.vx_mps, f.vy_mps);
  f.power_w = sum.power / n;
  f.leg_extension_power_w = sum.extension_power / n;
  f.torque_squared_nm2 = sum.torque2 / n;
  const double power = f.power_w + f.torque_squared_nm2 / square(facts.motor_constant);
  const double weight_n = facts.mass_kg * kGravity_mps2;
  f.cot = cost_of_transport(f.power_w, f.torque_squared_nm2, f.horizontal_speed_mps,
                            {.mass_kg = facts.mass_kg, .motor_constant = facts.motor_constant})
              .value_or(kNotDefined);
  if (std::fabs(f.yaw_rate_radps) >= 0.05) {
    f.turning_cot = power / (weight_n * facts.foot_diagonal_m * std::fabs(f.yaw_rate_radps));
  }
  std::array<double, kNumLegs> iqr_m{};
  f.clearance_iqr_m = 0.0;
  for (int l = 0; l < kNumLegs; ++l) {
    std::vector<double>& h = heights[l];
    std::sort(h.begin(), h.end());
    iqr_m[l] = quantile(h, 0.75) - quantile(h, 0.25);
    f.clearance_iqr_m += iqr_m[l] / kNumLegs;
  }
  f.least_clearance_iqr_m = *std::min_element(iqr_m.begin(), iqr_m.end());
  f.greatest_clearance_iqr_m = *std::max_element(iqr_m.begin(), iqr_m.end());
  f.stride_hz = lift_offs / (kNumLegs * n * kStep_s);
  f.duty = duty / n;
  f.body_height_m = sum.height / n;
  f.tilt_rms_rad = std::sqrt(sum.tilt2 / n);
  f.action_change_rad = sum.action_change / n;
  f.velocity_rmse_mps = std::sqrt(sum.estimate_velocity2 / n);
  f.body_height_rmse_m = std::sqrt(sum.estimate_height2 / n);
  f.foot_height_rmse_m = std::sqrt(sum.estimate_foot2 / n);
}

// Whether in the first `periods` no joint was past a stop for as long as a policy step. Such a
// stretch has its ticks in two periods; as many ticks that are not in a row count as well.
bool TrialRecorder::stops_brief(std::size_t periods) const {
  float before = 0.0f;
  for (std::size_t i = 0; i < periods; ++i) {
    const float now = periods_[i].past_stop;
    if (before + now > 1.0f - 1e-3f) return false;
    before = now;
  }
  return true;
}

void TrialRecorder::track_figures(const Trial& trial, const RobotFacts& facts,
                                  TrialFigures& f) const {
  // Time at which a distance was reached for the first time; the end of period i is the start of
  // period i + 1.
  const auto reached = [&](double distance) {
    for (std::size_t i = 0; i + 1 < periods_.size(); ++i) {
      const double from = periods_[i].distance, to = periods_[i + 1].distance;
      if (to < distance) continue;
      return (static_cast<double>(i) + (distance - from) / (to - from)) * kStep_s;
    }
    return kNotDefined;
  };
  const double begin_s = reached(trial.track_begin_m), end_s = reached(trial.track_end_m);
  const bool begun = !std::isnan(begin_s);
  const auto begin = begun ? static_cast<std::size_t>(begin_s / kStep_s) : periods_.size();
  f.failed_before_track = (!begun && f.fell) || !stops_brief(begin);
  if (std::isnan(end_s) || end_s > trial.longest_s) return;
  f.track_done = true;
  f.track_speed_mps = (trial.track_end_m - trial.track_begin_m) / (end_s - begin_s);
  const auto end = std::min(static_cast<std::size_t>(end_s / kStep_s) + 1, periods_.size());
  f.track_limits_kept =
      std::all_of(periods_.begin(), periods_.begin() + static_cast<std::ptrdiff_t>(end),
                  [](const Period& p) { return p.past_stop == 0.0f; });
  f.track_stops_brief = stops_brief(end);
  double power = 0.0;
  for (std::size_t i = begin; i < end; ++i) {
    power += periods_[i].power + periods_[i].torque2 / square(facts.motor_constant);
  }
  power /= static_cast<double>(end - begin);
  f.track_cot = power / (facts.mass_kg * kGravity_mps2 * f.track_speed_mps);
  // A gait cycle of this run in whole periods.
  double cycle_s = kUsualGaitCycle_s;
  if (f.stride_hz > 0.0) {
    cycle_s = std::clamp(1.0 / f.stride_hz, kShortestGaitCycle_s, kLongestGaitCycle_s);
  }
  const std::size_t cycle =
      std::min(static_cast<std::size_t>(std::lround(cycle_s / kStep_s)), end - begin);
  double sum = 0.0;
  for (std::size_t i = end - cycle; i < end; ++i) sum += periods_[i].vx;
  f.track_end_speed_mps = sum / static_cast<double>(cycle);
}

TrialFigures TrialRecorder::figures(const Trial& trial, bool fell, bool met,
                                    const RobotFacts& facts) const {
  TrialFigures f;
  f.fell = fell;
  f.time_s = time_s();
  if (trial.has_place()) f.disturbance_met = met ? 1.0 : 0.0;
  if (!fell) steady_figures(facts, f);
  if (trial.has_track()) track_figures(trial, facts, f);
  double too_fast = 0.0, past_stop = 0.0, velocity_error = 0.0, yaw_error = 0.0, turned = 0.0;
  for (std::size_t i = 0; i < periods_.size(); ++i) {
    const Period& p = periods_[i];
    too_fast += p.too_fast;
    past_stop += p.past_stop;
    turned += p.yaw_rate * kStep_s;
    if (i < kSettled) continue;
    velocity_error += p.velocity_error;
    yaw_error += p.yaw_error;
  }
  const double n = static_cast<double>(periods_.size());
  f.too_fast_share = too_fast / n;
  f.past_stop_share = past_stop / n;
  f.turned_rad = turned;
  f.torque_limit_share = torque_limit_steps_ / n;
  f.joint_speed_max_radps = joint_speed_max_;
  if (periods_.size() > kSettled) {
    f.velocity_error_mps = velocity_error / (n - kSettled);
    f.yaw_error_radps = yaw_error / (n - kSettled);
  }
  return f;
}

}  // namespace sandrunner::evaluate
