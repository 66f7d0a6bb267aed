// SPDX-License-Identifier: BSD-3-Clause
// One row of a run, at the policy's rate, and the one table of its fields: the CSV, the page, the
// live view and the figures of a run are made from rows.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "rt/core/messages.h"
#include "rt/report/row_field.h"

namespace sandrunner {

/// Bits of RunRow::flags. kRowCounts: the figures of the run are taken over this row.
inline constexpr std::uint32_t kRowHasTruth = 1, kRowHasEstimate = 2, kRowCounts = 4;

/// One moment, at the first tick of each of the policy's periods. World frame, legs and joints as
/// in messages.h. Without truth (hardware) the pose is that of the odometry, joints are as
/// measured, and what only a simulator knows is NaN.
struct RunRow {
  double t_s = 0.0;
  std::uint32_t mode = 0;
  std::array<float, 3> given{};  ///< command as the policy gets it: vx, vy, yaw rate
  Vector3 position_m{};          ///< of the base origin
  std::array<float, 4> orientation_wxyz{1.0f, 0.0f, 0.0f, 0.0f};
  std::array<double, 3> odometry{};    ///< dead-reckoned x, y, yaw; m, rad
  std::array<float, 3> requested{};    ///< command by the operator
  std::array<float, 3> motion{};       ///< vx, vy in the heading frame, yaw rate
  std::array<float, 3> mean_motion{};  ///< the same, mean since the row before
  JointArray<float> position_rad{}, velocity_radps{};
  JointArray<float> torque_nm{};
  JointArray<float> peak_torque_nm{};  ///< of largest size since the row before, with its sign
  std::array<std::array<float, 3>, kNumLegs> hip_m{}, knee_m{}, foot_m{};  ///< LegPoints
  /// Depth of the foot's deepest point below the undisturbed surface; below 0 in the air.
  std::array<float, kNumLegs> penetration_m{};
  std::array<float, kNumLegs> ground_height_m{};  ///< of the undisturbed surface under each foot
  std::array<float, kNumLegs> contact{};          ///< 1 or 0
  std::array<std::array<float, 3>, kNumLegs> foot_force_n{};  ///< of the ground on the foot
  /// x, y, depth where the foot is deepest so far in its present stance; depth 0: in the air.
  std::array<std::array<float, 3>, kNumLegs> stance_m{};
  std::array<float, 8> estimate{};            ///< of this row's sensors: StateEstimate; NaN: none
  std::array<float, 8> truth{};               ///< what `estimate` should be
  float power_w = 0, torque_squared_nm2 = 0;  ///< sums over joints, mean since the row before
  float cost_of_transport = 0;                ///< over the last second; NaN: not defined
  float late_us = 0, control_us = 0, tick_us = 0;  ///< worst since the row before; 0 in lockstep
  std::uint32_t joint_past_stop = 0, joint_too_fast = 0;  ///< ticks so far (GateCounters)
  std::uint32_t faults = 0, warnings = 0, flags = 0;
  std::uint32_t skipped = 0;  ///< ticks missed so far
};

#define ROW(member, ...) SANDRUNNER_ROW_FIELD(RunRow, member, __VA_ARGS__)
// A name, its columns in run.csv, and kNotOnPage if a page has no use for it.
// clang-format off
inline constexpr std::array kRowFields = {
    ROW(t_s, "t_s"),
    ROW(mode, "mode"),
    ROW(given, "command_vx_mps|command_vy_mps|command_wz_radps"),
    ROW(position_m, "base_{x,y,z}_m"),
    ROW(orientation_wxyz, "orientation_{w,x,y,z}"),
    ROW(odometry, "odometry_x_m|odometry_y_m|odometry_yaw_rad"),
    ROW(requested, "requested_vx_mps|requested_vy_mps|requested_wz_radps"),
    ROW(motion, "vx_mps|vy_mps|yaw_rate_radps"),
    ROW(mean_motion, "mean_vx_mps|mean_vy_mps|mean_yaw_rate_radps", kNotOnPage),
    ROW(position_rad, "{joint}_position_rad"),
    ROW(velocity_radps, "{joint}_velocity_radps"),
    ROW(torque_nm, "{joint}_torque_nm", kNotOnPage),
    ROW(peak_torque_nm, "{joint}_peak_torque_nm"),
    ROW(hip_m, "{leg}_hip_{x,y,z}_m", kNotOnPage),
    ROW(knee_m, "{leg}_knee_{x,y,z}_m", kNotOnPage),
    ROW(foot_m, "{leg}_foot_{x,y,z}_m", kNotOnPage),
    ROW(penetration_m, "{leg}_penetration_m"),
    ROW(ground_height_m, "{leg}_ground_height_m", kNotOnPage),
    ROW(contact, "{leg}_contact", kNotOnPage),
    ROW(foot_force_n, "{leg}_foot_force_{x,y,z}_n"),
    ROW(stance_m, "{leg}_stance_{x,y,depth}_m"),
    ROW(estimate, "estimate_body_height_m|estimate_velocity_{x,y,z}_mps|estimate_{leg}_foot_height_m"),
    ROW(truth, "truth_body_height_m|truth_velocity_{x,y,z}_mps|truth_{leg}_foot_height_m"),
    ROW(power_w, "power_w"),
    ROW(torque_squared_nm2, "torque_squared_nm2"),
    ROW(cost_of_transport, "cost_of_transport"),
    ROW(late_us, "late_us"),
    ROW(control_us, "control_us"),
    ROW(tick_us, "tick_us"),
    ROW(joint_past_stop, "joint_past_stop_ticks", kNotOnPage),
    ROW(joint_too_fast, "joint_too_fast_ticks", kNotOnPage),
    ROW(faults, "faults"),
    ROW(warnings, "warnings"),
    ROW(flags, "flags"),
    ROW(skipped, "skipped_ticks"),
};
// clang-format on
#undef ROW
static_assert(covers_row<RunRow>(kRowFields));

inline Mode mode_of(const RunRow& row) noexcept { return static_cast<Mode>(row.mode); }

/// A stance that ended.
struct Footprint {
  double t_s = 0.0;             ///< its end
  double x_m = 0.0, y_m = 0.0;  ///< where the foot was deepest
  float depth_m = 0.0f;
  std::uint32_t leg = 0;

  /// Whether it is worth drawing: hard ground takes no footprint.
  bool shows() const noexcept { return depth_m >= 0.002f; }
};

inline constexpr std::array kFootprintFields = {
    SANDRUNNER_ROW_FIELD(Footprint, t_s), SANDRUNNER_ROW_FIELD(Footprint, x_m),
    SANDRUNNER_ROW_FIELD(Footprint, y_m), SANDRUNNER_ROW_FIELD(Footprint, depth_m),
    SANDRUNNER_ROW_FIELD(Footprint, leg),
};
static_assert(covers_row<Footprint>(kFootprintFields));

}  // namespace sandrunner
