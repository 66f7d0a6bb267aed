// SPDX-License-Identifier: BSD-3-Clause
// What a run left behind, at the rate of the policy: the source of the CSV and of the pictures.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "rt/core/messages.h"

namespace sandrunner {

/// Positions are in the world frame; legs LF, RF, LH, RH; joints as in messages.h.
struct RunSample {
  double t_s = 0.0;
  Mode mode = Mode::kPassive;
  VelocityCommand command;
  Vector3 base_position_m{};
  std::array<double, 4> orientation_wxyz{1.0, 0.0, 0.0, 0.0};
  double vx_mps = 0.0;  ///< of the base origin, heading frame
  double vy_mps = 0.0;
  double yaw_rate_radps = 0.0;  ///< about world z
  JointArray<double> joint_position_rad{};
  JointArray<double> joint_velocity_radps{};
  JointArray<double> joint_torque_nm{};
  std::array<Vector3, kNumLegs> hip_position_m{};  ///< of the HFE axis
  std::array<Vector3, kNumLegs> knee_position_m{};
  std::array<Vector3, kNumLegs> foot_position_m{};  ///< of the foot's centre
  /// Depth of the foot's deepest point below the undisturbed surface; 0 or less in the air.
  std::array<double, kNumLegs> penetration_m{};
  std::array<double, kNumLegs> ground_height_m{};  ///< of the undisturbed surface under each foot
  std::array<bool, kNumLegs> contact{};
  bool has_estimate = false;  ///< whether the policy ran, so that `estimate` counts
  StateEstimate estimate;
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
  std::string terrain;  ///< name for titles
  std::string policy;   ///< name for titles, may be empty
  std::vector<RunSample> samples;
  std::vector<Footprint> footprints;
  /// Height of the undisturbed surface at x, y; unset: flat at 0.
  std::function<double(double x_m, double y_m)> ground_height_m;
  bool granular_ground = true;  ///< sand is drawn, else solid ground
  Vector3 base_box_size_m{0.7104, 0.276, 0.12};
  Vector3 base_box_center_m{0.0, 0.0, -0.03625};  ///< body frame
  double foot_radius_m = 0.0295;
};

}  // namespace sandrunner
