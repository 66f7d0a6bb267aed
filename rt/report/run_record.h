// SPDX-License-Identifier: BSD-3-Clause
// What a run left behind, at the rate of the policy: the source of the CSV and of the pictures.
#pragma once

#include <array>
#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "estimator/kinematics.h"
#include "rt/core/messages.h"

namespace sandrunner {

/// What figures and pictures must know of the robot and of the ground that it runs on.
struct RunScene {
  std::string terrain;  ///< name for titles; empty: not known
  std::string policy;   ///< name for titles, may be empty
  std::string note;     ///< a line for whoever looks at the run, may be empty
  std::array<std::string, kNumLegs> leg_names;
  JointArray<std::string> joint_names;
  double mass_kg = 0.0;
  double motor_constant = 0.0;  ///< k_m of the cost of transport, N m/sqrt(W) at the joint
  Vector3 base_box_size_m{};
  Vector3 base_box_center_m{};  ///< body frame
  double foot_radius_m = 0.0;
  /// Forward kinematics: from joint positions, rad.
  std::function<std::array<LegPoints, kNumLegs>(const JointArray<double>& position_rad)> leg_points;
  bool granular_ground = true;  ///< sand is drawn, else solid ground
  /// Height of the undisturbed surface at x, y, m; unset: flat at 0.
  std::function<double(double x_m, double y_m)> ground_height_m;
};

/// Positions are in the world frame; legs LF, RF, LH, RH; joints as in messages.h.
struct RunSample {
  double t_s = 0.0;
  Mode mode = Mode::kPassive;
  VelocityCommand command;
  // Of a robot that offers its truth this is the truth, else what its sensors say.
  std::array<double, 4> orientation_wxyz{1.0, 0.0, 0.0, 0.0};
  double yaw_rate_radps = 0.0;  ///< about world z
  JointArray<double> joint_position_rad{};
  JointArray<double> joint_velocity_radps{};
  JointArray<double> joint_torque_nm{};
  bool has_estimate = false;  ///< whether the policy ran, so that `estimate` counts
  StateEstimate estimate;

  bool has_truth = false;  ///< whether the rest is known
  Vector3 base_position_m{};
  double vx_mps = 0.0;  ///< of the base origin, heading frame
  double vy_mps = 0.0;
  std::array<Vector3, kNumLegs> hip_position_m{};  ///< of the HFE axis
  std::array<Vector3, kNumLegs> knee_position_m{};
  std::array<Vector3, kNumLegs> foot_position_m{};  ///< of the foot's centre
  /// Depth of the foot's deepest point below the undisturbed surface; 0 or less in the air.
  std::array<double, kNumLegs> penetration_m{};
  std::array<double, kNumLegs> ground_height_m{};  ///< of the undisturbed surface under each foot
  std::array<bool, kNumLegs> contact{};
  StateEstimate truth;  ///< what `estimate` should be
};

/// What a foot left in granular ground when its stance ended.
struct Footprint {
  double t_s = 0.0;  ///< end of the stance
  double x_m = 0.0;
  double y_m = 0.0;
  double depth_m = 0.0;
};

struct RunRecord {
  RunScene scene;
  /// At the policy's rate; of a run of more than 11 minutes every second, fourth, ...
  std::deque<RunSample> samples;
  std::vector<Footprint> footprints;

  /// Whether positions, speeds and the ground are known: else there is nothing to be seen from the
  /// side.
  bool has_truth() const { return !samples.empty() && samples.front().has_truth; }
};

}  // namespace sandrunner
