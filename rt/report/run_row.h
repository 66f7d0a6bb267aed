// SPDX-License-Identifier: BSD-3-Clause
// One row of a run, at the policy's rate, and the one table of its fields: the CSV, the page, the
// live view, the figures and the pictures of a run are made from rows.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "rt/core/messages.h"

namespace sandrunner {

/// Some numbers of a row, next to each other; little-endian.
struct RowField {
  const char* name;
  const char* type;  ///< "f64", "f32", "u32", "i32" or "i16"
  std::size_t offset, count;
  /// Names of the numbers as columns of run.csv (run_csv.h); of a field that is in rows only.
  const char* columns = "";
  bool on_page = true;  ///< a page gets it; else it is for the CSV, figures and pictures alone

  /// Of one of the numbers, bytes.
  std::size_t width() const noexcept;
};

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
  std::uint32_t faults = 0, flags = 0;
  std::uint32_t skipped = 0;  ///< ticks missed so far
};

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

std::span<const RowField> row_fields();
std::span<const RowField> footprint_fields();

}  // namespace sandrunner
