// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <deque>
#include <functional>
#include <string>

#include "rt/core/robot_description.h"
#include "rt/report/run_row.h"

namespace sandrunner {

/// What rows, figures and pages must know of the robot and of the ground that it runs on.
struct RunScene {
  std::string terrain = {};  ///< name for titles; empty: not known
  std::string policy = {};   ///< name for titles, may be empty
  std::string note = {};     ///< a line for the reader of a page, may be empty
  RobotDescription robot = {};
  double mass_kg = 0.0;
  LegJoints<double> motor_constant{};  ///< k_m of the cost of transport, N m/sqrt(W) at the joint
  double foot_radius_m = 0.0;
  bool granular_ground = true;       ///< sand is drawn, else solid ground
  std::array<double, 2> slope = {};  ///< gradient of the ground's plane, which goes through 0
  /// Height of the ground's waves over its plane at x, y, m; unset: none.
  std::function<double(double x_m, double y_m)> waves_m = {};

  /// Height of the undisturbed surface at x, y, m.
  double ground_height_m(double x_m, double y_m) const {
    return slope[0] * x_m + slope[1] * y_m + (waves_m ? waves_m(x_m, y_m) : 0.0);
  }
};

/// All of a run in bounded memory. Of a run of more than 11 minutes only every second row is kept,
/// then every fourth, ... A row that is left out hands its extremes, and its share in the means, on
/// to the next one.
struct RunRecord {
  static constexpr std::size_t kMostRows = 1 << 16;        // 50 MB
  static constexpr std::size_t kMostFootprints = 1 << 16;  // 2 MB, two hours of a trot

  RunScene scene = {};
  std::deque<RunRow> rows = {};
  std::deque<Footprint> footprints = {};  ///< the newest ones
  std::size_t periods_per_row = 1;
  RunRow left_out = {};              ///< newer than all rows
  std::size_t periods_left_out = 0;  ///< that `left_out` stands for

  void add(const RunRow& row);
  void add(const Footprint& footprint);
  /// Leaves every second row out.
  void thin();

  /// Whether positions, speeds and the ground are known: else there is nothing to be seen from the
  /// side.
  bool has_truth() const { return !rows.empty() && (rows.front().flags & kRowHasTruth) != 0; }
};

}  // namespace sandrunner
