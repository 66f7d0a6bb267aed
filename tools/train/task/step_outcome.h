// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "rt/core/messages.h"

namespace sandrunner::train {

/// What a policy step (10 ms) is judged by. Velocities are those of the base origin in the heading
/// frame; on a slope vz is away from it.
struct StepOutcome {
  std::array<float, 3> command{};       ///< vx, vy (m/s), yaw rate (rad/s)
  float vx = 0, vy = 0, vz = 0;         ///< m/s
  float yaw_rate = 0;                   ///< about world z, rad/s
  std::array<float, 3> drift{};         ///< vx, vy, yaw rate over the last stride or so
  float roll_rate = 0, pitch_rate = 0;  ///< body frame, rad/s
  float up_z = 1;                       ///< cosine of the tilt to the ground's plane
  float body_height = 0;                ///< above the deformed ground, m
  JointArray<float> q{}, nominal{};     ///< rad
  /// Now, one and two steps ago; network units.
  JointArray<float> action{}, action_1{}, action_2{};
  // Means over the period's ticks.
  float torque_squared = 0;  ///< sum over joints, N^2 m^2
  float power = 0;           ///< mechanical, signed, W
  float speed_squared = 0;   ///< sum over joints, rad^2/s^2
  float speed_excess = 0;  ///< squares of the joint speeds above a share of their limit, rad^2/s^2
  float past_stop = 0;     ///< share of the ticks in which a joint was past its stop
  float slip = 0;          ///< sum over feet in contact of v_xy^2, m^2/s^2
  std::array<float, kNumLegs> air_s{}, stance_s{};  ///< since when each foot is in the air, loaded
  std::array<bool, kNumLegs> contact{};             ///< the foot is loaded
  /// Of a foot that touched down in this step: since its last touchdown; else 0.
  std::array<float, kNumLegs> stride_s{};
  std::array<float, kNumLegs> foot_clearance{};  ///< of its lowest point above the surface, m
  std::array<float, kNumLegs> foot_speed{};      ///< horizontal, m/s
  int lift_offs = 0;  ///< feet that were loaded a step ago and are not now
  bool fell = false;
};

/// Square of the commanded speed, m^2/s^2.
inline double command_speed2(const StepOutcome& s) {
  return s.command[0] * s.command[0] + s.command[1] * s.command[1];
}

/// How much counts as made of a commanded motion, for the share that is, over the last stride: in
/// full from 0.95 on. A gait swings about its mean, and where each moment counts, at most in full,
/// or only the whole does, going too fast has more moments in full.
inline double made(double share) { return std::clamp(share / 0.95, -1.0, 1.0); }

/// How much of the commanded motion the robot makes, 0 to 1; 1 for a command to stand.
inline double progress(const StepOutcome& s) {
  const double speed2 = command_speed2(s);
  double share = 1.0;
  if (speed2 > 0.01) {
    share = (s.drift[0] * s.command[0] + s.drift[1] * s.command[1]) / speed2;
  } else if (std::fabs(s.command[2]) > 0.1f) {
    share = s.drift[2] / s.command[2];
  }
  return std::max(made(share), 0.0);
}

}  // namespace sandrunner::train
