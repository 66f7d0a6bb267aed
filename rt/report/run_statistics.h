// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "rt/core/messages.h"
#include "rt/loop/tick_record.h"
#include "rt/report/run_record.h"
#include "rt/report/stances.h"

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
  /// Mean signed sum of tau qd and mean of the sum over joints of tau^2; tau is the true torque
  /// after the clamp, or else what the drives report.
  double mechanical_power_w = 0.0, torque_squared_nm2 = 0.0;
  std::int64_t joint_limit_steps = 0;  ///< ticks with a joint past its stop
  std::int64_t speed_limit_steps = 0;  ///< ticks with a joint above its speed limit
  std::optional<MotionFigures> motion;
  std::optional<EstimateErrors> estimate;
};

/// Collects figures from the ticks that count, in bounded memory: the half that counts begins to
/// 10 ms where it should, after 11 minutes to 20 ms, after a day to 3 s, and of the feet's heights
/// ever fewer are kept.
class RunStatistics {
 public:
  /// Every tick, in order. `truth`: what the estimate that came with this tick should be; null:
  /// none came.
  void add(const TickRecord& tick, const StateEstimate* truth);
  /// Figures so far. `mass_kg`, `motor_constant` (N m/sqrt(W)): for the cost of transport.
  RunFigures figures(double mass_kg, double motor_constant) const;
  /// Time that the ticks so far make.
  double time_s() const noexcept;
  /// The newest 65,536: two hours of a trot.
  const std::deque<Footprint>& footprints() const noexcept { return footprints_; }

 private:
  // Sums over one policy period, or over several in a row.
  struct Period {
    std::int64_t periods = 1, ticks = 0, estimates = 0;
    bool has_truth = false;
    double vx = 0, vy = 0, yaw_rate = 0, power = 0, torque_squared = 0;
    VelocityCommand command;
    double velocity_error2 = 0, height_error2 = 0, foot_error2 = 0;
    std::int64_t past_stop = 0, too_fast = 0;
    int stances = 0;
    double sinkage = 0, sinkage_max = 0;
    std::array<double, kNumLegs> foot_height{};  // relative to the base, at the end

    void add(const Period& next) noexcept;
  };
  void end_period();
  double foot_clearance_iqr_m(std::size_t begin) const;  // of the periods from `begin` on

  GateCounters counters_;  // of the last tick
  std::vector<Period> periods_;
  std::int64_t periods_each_ = 1;  // policy periods in each of these, the last may have fewer
  Period present_;                 // the policy period that is not yet over
  StanceWatch stances_;
  std::deque<Footprint> footprints_;
};

}  // namespace sandrunner
