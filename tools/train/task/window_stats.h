// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "tools/train/task/reward.h"

namespace sandrunner::train {

/// Means of a window, for the progress line, the learning curve and the curricula. [0] rigid, [1]
/// soil.
struct WindowStats {
  double reward = 0.0;
  std::array<double, kRewardTerms> terms{};  ///< of the reward (Reward::terms)
  std::array<double, 2> kernel{};            ///< velocity kernel
  std::array<double, 2> falls{};             ///< per 4 s and robot
  /// Speed along the command over the command, where it is above 0.3 m/s.
  std::array<double, 2> speed_ratio{};
  double top_kernel = 0.0;     ///< on decisive ground, commands above 3/4 of the curriculum's speed
  double top_steps = 0.0;      ///< number of steps in that mean
  double body_height_m = 0.0;  ///< on rigid ground
  double torque_squared = 0.0;  ///< sum over joints, N^2 m^2
  double power_w = 0.0;
  double stride_hz = 0.0;  ///< lift-offs of a foot per second
  /// How feet go together under a command to go, side by side ones and diagonal ones: 1
  /// together, 0 like independent feet, below 0 alternating. Share of the steps in which both are
  /// loaded or both not, a, as (a - b)/(1 - b), b that of independent feet.
  double abreast = 0.0, diagonal = 0.0;
};

/// Sums over the steps of a window, all double (rt/base/add_members.h).
class WindowSums {
 public:
  /// A step on ground of this kind (0 rigid, 1 soil). `top_speed_mps`: the curriculum's, which
  /// depends on the steps on ground of kind `decisive`. `velocity` has the kernel that is averaged.
  void add_step(const StepOutcome& s, const Reward& reward, int kind, int decisive,
                double top_speed_mps, const reward::Velocity& velocity);
  void add_fall(int kind) { falls_[kind] += 1.0; }
  WindowStats means() const;

 private:
  double steps_ = 0, reward_ = 0, torque_squared_ = 0, power_ = 0, lift_offs_ = 0;
  std::array<double, kRewardTerms> terms_{};
  double height_ = 0, height_steps_ = 0;
  double abreast_ = 0, diagonal_ = 0, loaded_ = 0, gait_steps_ = 0;
  double top_kernel_ = 0, top_steps_ = 0;
  std::array<double, 2> kernel_{}, kind_steps_{}, falls_{}, ratio_{}, ratio_steps_{};
};

}  // namespace sandrunner::train
