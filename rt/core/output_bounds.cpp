// SPDX-License-Identifier: BSD-3-Clause
#include "rt/core/output_bounds.h"

#include <algorithm>
#include <cmath>

#include "rt/core/joint_pd.h"

namespace sandrunner {
namespace {

/// Clamps all values; whether one had to be.
bool clamp_all(JointArray<double>& values, const JointArray<double>& lower,
               const JointArray<double>& upper) noexcept {
  bool clamped = false;
  for (int j = 0; j < kNumJoints; ++j) {
    const double allowed = clamp_to(values[j], lower[j], upper[j]);
    clamped = clamped || allowed != values[j];
    values[j] = allowed;
  }
  return clamped;
}

double torque_of(const JointCommand& c, const JointState& joints, int j) noexcept {
  return joint_torque(joints.position_rad[j], joints.velocity_radps[j], c.position_rad[j],
                      c.velocity_radps[j], c.kp_nmprad[j], c.kd_nmsprad[j], c.feedforward_nm[j]);
}

/// Changes the command of joint j so that it gives `wanted_nm` instead of `given_nm`.
void move_torque(JointCommand& c, int j, double given_nm, double wanted_nm) noexcept {
  if (c.kp_nmprad[j] > 0.0) {
    c.position_rad[j] += (wanted_nm - given_nm) / c.kp_nmprad[j];
  } else {
    // No target to move: a weaker command of the same kind. Damping then stays damping.
    const double share = wanted_nm / given_nm;
    c.kd_nmsprad[j] *= share;
    c.feedforward_nm[j] *= share;
  }
}

}  // namespace

OutputBounds::OutputBounds(const GateConfig& config) noexcept
    : torque_limit_nm_(config.torque_limit_nm),
      target_step_rad_(config.target_step_rad),
      power_limit_w_(config.power_limit_w) {
  for (int j = 0; j < kNumJoints; ++j) {
    lower_.position_rad[j] = config.joint_lower_rad[j] - config.target_margin_rad;
    upper_.position_rad[j] = config.joint_upper_rad[j] + config.target_margin_rad;
    upper_.velocity_radps[j] = config.speed_limit_radps[j];
    lower_.velocity_radps[j] = -config.speed_limit_radps[j];
  }
  upper_.kp_nmprad.fill(config.kp_limit_nmprad);
  upper_.kd_nmsprad.fill(config.kd_limit_nmsprad);
}

OutputBounds::Result OutputBounds::apply(const JointState& joints,
                                         const JointArray<double>* before_rad, double torque_share,
                                         JointCommand& command,
                                         GateCounters& counters) const noexcept {
  const bool kp_clamped = clamp_all(command.kp_nmprad, lower_.kp_nmprad, upper_.kp_nmprad);
  const bool kd_clamped = clamp_all(command.kd_nmsprad, lower_.kd_nmsprad, upper_.kd_nmsprad);
  if (kp_clamped || kd_clamped) ++counters.gains_clamped;

  bool position_clamped = clamp_all(command.position_rad, lower_.position_rad, upper_.position_rad);
  if (before_rad != nullptr) {
    JointArray<double> from, to;
    for (int j = 0; j < kNumJoints; ++j) {
      from[j] = (*before_rad)[j] - target_step_rad_;
      to[j] = (*before_rad)[j] + target_step_rad_;
    }
    position_clamped = clamp_all(command.position_rad, from, to) || position_clamped;
  }
  if (position_clamped) ++counters.position_clamped;
  if (clamp_all(command.velocity_radps, lower_.velocity_radps, upper_.velocity_radps)) {
    ++counters.velocity_clamped;
  }
  Result result{.asked_rad = command.position_rad, .torque_nm = {}};

  JointArray<double>& torque_nm = result.torque_nm;
  bool torque_clamped = false;
  double power_w = 0.0;
  for (int j = 0; j < kNumJoints; ++j) {
    const double limit_nm = torque_share * torque_limit_nm_[j];
    const double given_nm = torque_of(command, joints, j);
    torque_nm[j] = clamp_to(given_nm, -limit_nm, limit_nm);
    if (torque_nm[j] != given_nm) {
      torque_clamped = true;
      move_torque(command, j, given_nm, torque_nm[j]);
    }
    power_w += std::max(torque_nm[j] * joints.velocity_radps[j], 0.0);
  }
  if (torque_clamped) ++counters.torque_clamped;
  if (power_w > power_limit_w_) {
    ++counters.power_clamped;
    const double share = power_limit_w_ / power_w;
    for (int j = 0; j < kNumJoints; ++j) {
      if (torque_nm[j] * joints.velocity_radps[j] <= 0.0) continue;  // brakes
      move_torque(command, j, torque_nm[j], share * torque_nm[j]);
      torque_nm[j] *= share;
    }
  }
  return result;
}

}  // namespace sandrunner
