// SPDX-License-Identifier: BSD-3-Clause
// The figures of one run of one robot. Where rt/report/run_figures.h has the same figure, the
// definition is the same. "Steady" is the second half of the run.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "rt/core/messages.h"
#include "sim/batch/batch.h"
#include "tools/evaluate/trial.h"

namespace sandrunner::evaluate {

inline constexpr double kNotDefined = std::numeric_limits<double>::quiet_NaN();

/// Speeds in the heading frame. Steady figures are nan for a run that fell; every figure is nan
/// where it is not defined.
struct TrialFigures {
  double time_s = 0.0;  ///< until the end or the fall
  bool fell = false;    ///< base or thigh touched the ground, or the simulation diverged
  /// 1 or 0: the robot reached the ground that changes, or its loose step; nan: there is none.
  double disturbance_met = kNotDefined;

  // Track.
  bool track_done = false;         ///< reached its end without a fall and in time
  bool track_limits_kept = false;  ///< and until there no joint was past a stop at any tick
  bool track_stops_brief = false;  ///< or none was for as long as a policy step
  /// Fell before its start line, or a joint was past a stop there for as long as a policy step.
  bool failed_before_track = false;
  double track_speed_mps = kNotDefined;  ///< length over time
  double track_cot = kNotDefined;        ///< (P_mech + P_heat)/(m g v), from start to end line
  double track_end_speed_mps =
      kNotDefined;  ///< mean vx of the last gait cycle before the end of the track

  // Steady.
  double vx_mps = kNotDefined, vy_mps = kNotDefined, yaw_rate_radps = kNotDefined;
  double horizontal_speed_mps = kNotDefined;  ///< length of the mean (vx, vy)
  double power_w = kNotDefined;               ///< mechanical, mean signed sum of tau qd
  double torque_squared_nm2 = kNotDefined;    ///< mean of sim::BatchSums::torque_squared
  double cot = kNotDefined;                   ///< P/(m g |v_xy|); not below 0.05 m/s
  double turning_cot = kNotDefined;  ///< P/(m g l_c |wz|), l_c diagonal foot distance; paper, CoTu
  /// Interquartile range of the height of a foot: mean of the four ...
  double clearance_iqr_m = kNotDefined;
  double least_clearance_iqr_m = kNotDefined;     ///< ... of the foot with the least ...
  double greatest_clearance_iqr_m = kNotDefined;  ///< ... and with the greatest
  /// Paper, P_mech^E: mean sum over HFE and KFE of max(tau, 0) max(qd, 0).
  double leg_extension_power_w = kNotDefined;
  double stride_hz = kNotDefined;          ///< lift-offs of a foot per second
  double duty = kNotDefined;               ///< share of 10 ms periods in which a foot is loaded
  double body_height_m = kNotDefined;      ///< above the deformed ground
  double tilt_rms_rad = kNotDefined;       ///< between the body's and the world's z axis
  double action_change_rad = kNotDefined;  ///< mean length of the joint targets' change a step
  double velocity_rmse_mps = kNotDefined, body_height_rmse_m = kNotDefined,
         foot_height_rmse_m = kNotDefined;

  // The whole run.
  double too_fast_share = 0.0;      ///< of control ticks, a joint above its speed limit
  double past_stop_share = 0.0;     ///< of control ticks, a joint past its stop
  double torque_limit_share = 0.0;  ///< of policy steps whose new targets ask for the torque limit
  double joint_speed_max_radps = 0.0;  ///< of the samples at 100 Hz
  double turned_rad = 0.0;             ///< integral of the yaw rate

  // From 1 s on, until the end or the fall.
  double velocity_error_mps = kNotDefined;  ///< mean length of the error of (vx, vy)
  double yaw_error_radps = kNotDefined;     ///< mean |error|
};

/// What does not change between runs.
struct RobotFacts {
  double mass_kg = 0.0;
  double motor_constant = 0.0;   ///< k_m of HAA, N m/sqrt(W) at the joint
  double foot_diagonal_m = 0.0;  ///< l_c: LF to RH in the nominal pose
  JointArray<double> torque_limit_nm{};
};

/// Collects one run, policy step by policy step.
class TrialRecorder {
 public:
  /// What the policy step at the start of a period saw and asked for.
  void begin_period(const sim::RobotState<float>& state, const StateEstimate& truth,
                    const StateEstimate& estimate, const VelocityCommand& command,
                    const JointArray<double>& target_before, const JointArray<double>& target,
                    double kp, double kd, const RobotFacts& facts);
  /// What happened in the 10 ms since.
  void end_period(const sim::BatchSums<float>& sums);

  double time_s() const noexcept { return static_cast<double>(periods_.size()) / kPolicyHz; }
  double distance_m() const noexcept { return distance_m_; }

  /// `met`: came to the disturbance, if the trial has one at a place.
  TrialFigures figures(const Trial& trial, bool fell, bool met, const RobotFacts& facts) const;

 private:
  // Floats alone (rt/base/add_members.h).
  struct Period {
    float distance = 0;  // at its start
    float vx = 0, vy = 0, yaw_rate = 0, height = 0, tilt2 = 0;
    float velocity_error = 0, yaw_error = 0, action_change = 0;
    float estimate_velocity2 = 0, estimate_height2 = 0, estimate_foot2 = 0;
    std::array<float, kNumLegs> foot_height{}, load{};
    float power = 0, extension_power = 0, torque2 = 0, too_fast = 0, past_stop = 0;
  };
  void track_figures(const Trial& trial, const RobotFacts& facts, TrialFigures& f) const;
  bool stops_brief(std::size_t periods) const;
  void steady_figures(const RobotFacts& facts, TrialFigures& f) const;

  std::vector<Period> periods_;
  double distance_m_ = 0.0;
  double joint_speed_max_ = 0.0;
  int torque_limit_steps_ = 0;
};

}  // namespace sandrunner::evaluate
