// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "estimator/kinematics.h"
#include "rt/core/controller.h"
#include "rt/core/robot_description.h"

namespace sandrunner {

/// Dead reckoning in a frame that never jumps (REP 105's "odom"). It starts above the origin.
///
/// In Walk, the velocity is the network's estimate. A robot of which no joint and no axis moves is
/// taken to stand or lie still. All else (standing up, falling, being let down) is not known: the
/// position stays, and the covariances say so. The attitude is the IMU's. The height is that above
/// the ground below: the network's estimate in Walk, else how far the robot's lowest part is below
/// the base, by its joints; one blends into the other.
class Odometry {
 public:
  explicit Odometry(const RobotDescription& robot);

  /// Every tick, in order. The velocity of a tick also holds for slots missed before it.
  void add(const ControllerInput& input, const ControllerOutput& output) noexcept;

  const Vector3& position_m() const noexcept { return position_m_; }
  const std::array<double, 4>& orientation_wxyz() const noexcept { return orientation_wxyz_; }
  const Vector3& velocity_mps() const noexcept { return velocity_mps_; }  ///< body frame
  const Vector3& angular_velocity_radps() const noexcept { return angular_velocity_radps_; }

  /// 6 x 6, row by row, as in nav_msgs/Odometry: x, y, z, then rotations about these axes. The
  /// variances of x, y and yaw only grow: nothing that the robot senses tells it where it is.
  std::array<double, 36> pose_covariance() const noexcept;
  std::array<double, 36> twist_covariance() const noexcept;

 private:
  /// Where the velocity comes from.
  enum class Source { kNone, kStill, kNetwork };
  bool moves(const SensorFrame& sensors, double dt_s) noexcept;
  Source source_of(const ControllerInput& input, const ControllerOutput& output) const noexcept;
  double height_by_joints_m(const JointArray<double>& position_rad) noexcept;
  void follow_height(double height_m, double dt_s) noexcept;

  Kinematics kinematics_;
  bool has_last_ = false;
  std::uint64_t last_tick_ = 0, restless_tick_ = 0;
  double acceleration_mps2_ = 0.0;  // the IMU's less gravity, smoothed
  Source source_ = Source::kNone;
  Vector3 position_m_{};
  std::array<double, 4> orientation_wxyz_{1.0, 0.0, 0.0, 0.0};
  Vector3 velocity_mps_{};
  Vector3 angular_velocity_radps_{};
  double horizontal_variance_m2_ = 0.0, yaw_variance_rad2_ = 0.0;
};

/// A variance so large that it means: not known.
inline constexpr double kUnknownVariance = 1e6;

}  // namespace sandrunner
