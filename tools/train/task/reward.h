// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "rt/core/messages.h"
#include "tools/train/task/task_config.h"

namespace sandrunner::train {

/// What a policy step (10 ms) is judged by. Velocities in the heading frame.
struct StepOutcome {
  std::array<float, 3> command{};       ///< vx, vy, wz
  float vx = 0, vy = 0, vz = 0;         ///< base origin, m/s
  float yaw_rate = 0;                   ///< about world z, rad/s
  std::array<float, 3> drift{};         ///< vx, vy, yaw rate over the last stride or so
  float roll_rate = 0, pitch_rate = 0;  ///< body frame, rad/s
  float up_z = 1;                       ///< cosine of the tilt
  float body_height = 0;                ///< above the deformed ground, m
  JointArray<float> q{}, nominal{};
  JointArray<float> action{}, action_1{},
      action_2{};  ///< now, one and two steps ago; network units
  float torque_squared = 0, power = 0, speed_squared = 0,
        speed_excess = 0;  ///< means over the period's ticks
  float slip = 0;          ///< mean sum over feet in contact of v_xy^2
  std::array<float, kNumLegs> air_s{},
      stance_s{};  ///< how long each foot has been in the air / loaded
  std::array<bool, kNumLegs> contact{};
  std::array<float, kNumLegs>
      foot_clearance{};                      ///< of the foot's lowest point above the surface, m
  std::array<float, kNumLegs> foot_speed{};  ///< horizontal, m/s
};

/// How well the commanded velocity is kept: 1 exactly, towards 0 far from it. The curricula look at
/// this too.
inline float velocity_kernel(const StepOutcome& s, double width, double width_per_speed2) {
  const double ex = s.command[0] - s.vx, ey = s.command[1] - s.vy;
  const double speed2 = s.command[0] * s.command[0] + s.command[1] * s.command[1];
  return static_cast<float>(std::exp(-(ex * ex + ey * ey) / (width + width_per_speed2 * speed2)));
}

/// Share of the commanded motion that the robot makes, 0 to 1; 1 for a command to stand.
inline double progress(const StepOutcome& s) {
  const double speed2 = s.command[0] * s.command[0] + s.command[1] * s.command[1];
  double share = 1.0;
  if (speed2 > 0.01) {
    share = (s.vx * s.command[0] + s.vy * s.command[1]) / speed2;
  } else if (std::fabs(s.command[2]) > 0.1f) {
    share = s.yaw_rate / s.command[2];
  }
  return std::clamp(share, 0.0, 1.0);
}

/// Sum of what is paid.
inline double positive_reward(const StepOutcome& s, const RewardSettings& r) {
  const double speed2 = s.command[0] * s.command[0] + s.command[1] * s.command[1];
  const double yaw_error = s.command[2] - s.yaw_rate;
  double sum =
      r.velocity_weight * velocity_kernel(s, r.velocity_width, r.velocity_width_per_speed2);
  if (speed2 > 0.01) {
    const double along = s.vx * s.command[0] + s.vy * s.command[1];
    sum += r.progress_weight * std::clamp(along / speed2, -1.0, 1.0);
  }
  sum += r.yaw_weight * std::exp(-yaw_error * yaw_error / r.yaw_width);
  if (std::fabs(s.command[2]) > 0.1f) {
    sum += r.yaw_progress_weight *
           std::clamp(static_cast<double>(s.yaw_rate / s.command[2]), -1.0, 1.0);
  }
  // Pointed kernels of the velocities without the gait's own swing: every bit of drift costs. None
  // for standing while asked to go.
  const double ex = std::fabs(s.command[0] - s.drift[0]), ey = std::fabs(s.command[1] - s.drift[1]),
               ew = std::fabs(s.command[2] - s.drift[2]);
  const double width =
      r.precise_forward_width + r.precise_forward_width_per_speed * std::fabs(double(s.command[0]));
  sum += progress(s) * (r.precise_forward_weight * std::exp(-ex / width) +
                        r.precise_drift_weight *
                            std::exp(-ey / r.precise_lateral_width - ew / r.precise_yaw_width));
  const bool still = speed2 < 1e-4 && std::fabs(s.command[2]) < 1e-2f;
  double air = 0.0;
  for (int l = 0; l < kNumLegs; ++l) {
    if (still) {
      air += std::clamp<double>(s.stance_s[l] - s.air_s[l], -r.air_target_s, r.air_target_s);
    } else if (s.contact[l]) {
      if (s.stance_s[l] < r.stance_longest_s)
        air += std::min<double>(s.stance_s[l], r.air_target_s);
    } else if (s.air_s[l] < r.air_longest_s) {
      air += std::min<double>(s.air_s[l], r.air_target_s);
    }
  }
  return sum + r.air_weight * air;
}

/// Factors of the costs, which grow during training.
struct CostRamp {
  double all = 1.0;     ///< of every cost
  double energy = 1.0;  ///< of that of energy, besides
  double late = 0.0;    ///< 0 to 1: how much of what comes late in the training is on
};

/// Sum of what is charged, before its weight.
inline double cost(const StepOutcome& s, const RewardSettings& r, double energy_factor) {
  // Energy for the way, not for the time: cost of transport counts at every speed. A way sideways,
  // backwards or round is dear by nature: were it charged like one ahead, standing would be
  // cheaper.
  const double ahead = s.command[0] > 0.0f ? s.command[0] : -2.0 * s.command[0];
  const double way = std::hypot(ahead, 2.0 * s.command[1]) + 0.5 * std::fabs(s.command[2]);
  const double energy = r.torque * s.torque_squared + r.power * std::max(s.power, 0.0f);
  double sum = energy * energy_factor * r.energy_speed_mps / (r.energy_offset_mps + way) +
               r.joint_speed * s.speed_squared + r.speed_excess * s.speed_excess + r.slip * s.slip;
  double first = 0.0, second = 0.0, pose = 0.0, overrun = 0.0;
  const bool still =
      std::fabs(s.command[0]) + std::fabs(s.command[1]) + std::fabs(s.command[2]) < 1e-3f;
  for (int j = 0; j < kNumJoints; ++j) {
    const double d1 = s.action[j] - s.action_1[j];
    const double d2 = d1 - (s.action_1[j] - s.action_2[j]);
    first += d1 * d1;
    second += d2 * d2;
    const double off = s.q[j] - s.nominal[j];
    pose += (j % 3 == 0 ? 1.0 : r.pose_flexion_share) * off * off;
    if (j % 3 == 2)
      overrun += std::max(std::max(s.q[j] - r.knee_high_rad, r.knee_low_rad - s.q[j]), 0.0);
  }
  sum += r.smoothness_1 * first + r.smoothness_2 * second + (still ? 2.0 : 1.0) * r.pose * pose +
         r.joint_margin * overrun;
  const double tilt = std::acos(std::clamp<double>(s.up_z, -1.0, 1.0));
  sum += r.orientation * tilt * tilt + r.base_vertical * s.vz * s.vz +
         r.base_roll_pitch * (std::fabs(s.roll_rate) + std::fabs(s.pitch_rate));
  const double low = std::max(r.height_m - s.body_height, 0.0);
  sum += r.height * low * low;
  for (int l = 0; l < kNumLegs; ++l) {
    if (s.contact[l]) continue;
    const double lack = std::max(r.clearance_m - s.foot_clearance[l], 0.0);
    sum += r.clearance * lack * lack * std::sqrt(static_cast<double>(s.foot_speed[l]));
  }
  return sum;
}

/// Reward of a step.
inline float reward(const StepOutcome& s, const RewardSettings& r, const CostRamp& ramp) {
  return static_cast<float>(
      r.scale *
      std::max(positive_reward(s, r) - r.cost_weight * ramp.all * cost(s, r, ramp.energy), 0.0));
}

}  // namespace sandrunner::train
