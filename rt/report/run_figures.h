// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "rt/report/run_record.h"

namespace sandrunner {

/// How the robot really moved: known of one that offers its truth.
struct MotionFigures {
  std::array<double, 2> mean_velocity_mps{};  ///< of the base origin, heading frame
  double mean_yaw_rate_radps = 0.0;           ///< about world z
  /// Deepest penetration of the contact point in each stance, mean and maximum over the stances
  /// (stances.h) that ended in that half.
  double sinkage_mean_m = 0.0, sinkage_max_m = 0.0;
  int stances = 0;
  /// Interquartile range of a foot centre's height relative to the base origin (world vertical),
  /// mean over the feet.
  double foot_clearance_iqr_m = 0.0;
  /// (P_mech + P_heat)/(m g |vx|) with P_heat = sum tau^2/k_m^2 (paper, "Beach sand"); none below
  /// 0.05 m/s.
  std::optional<double> cost_of_transport;
};

/// Root mean square errors of the network's estimates.
struct EstimateErrors {
  double velocity_rmse_mps = 0.0;  ///< of the length of the velocity error
  double body_height_rmse_m = 0.0;
  double foot_height_rmse_m = 0.0;  ///< over all feet
};

/// Figures of a run over the second half of its time in Walk.
struct RunFigures {
  std::array<double, 2> mean_command_mps{};  ///< vx, vy as given to the policy
  double mean_yaw_command_radps = 0.0;
  /// Mean signed sum of tau qd and mean of the sum over joints of tau^2, with tau times its
  /// heat factor; tau is the true torque after the clamp, or else what the drives report.
  double mechanical_power_w = 0.0, torque_squared_nm2 = 0.0;
  std::int64_t joint_limit_steps = 0;  ///< ticks with a joint past its stop
  std::int64_t speed_limit_steps = 0;  ///< ticks with a joint above its speed limit
  std::optional<MotionFigures> motion;
  std::optional<EstimateErrors> estimate;

  /// How much of the mean command the mean motion was: 1 follows it, 0 stands, -1 goes backward; a
  /// yaw rate counts as the speed at half a metre. None without a command, or without the truth.
  std::optional<double> followed() const noexcept;
};

/// Of the second half of the rows that count.
RunFigures run_figures(const RunRecord& record);

}  // namespace sandrunner
