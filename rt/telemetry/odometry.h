// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "rt/loop/tick_record.h"

namespace sandrunner {

/// Dead reckoning from the network's estimate of the base velocity and the IMU's attitude. Starts
/// at the origin. Without an estimate (outside Walk) the robot is assumed to stay where it is.
class Odometry {
 public:
  /// Every tick, in order. The velocity of a tick also holds for slots missed before it.
  void add(const TickRecord& tick) noexcept;

  const Vector3& position_m() const noexcept {
    return position_m_;
  }  ///< z: estimated height of the body
  const std::array<double, 4>& orientation_wxyz() const noexcept { return orientation_wxyz_; }
  const Vector3& velocity_mps() const noexcept { return velocity_mps_; }  ///< body frame
  const Vector3& angular_velocity_radps() const noexcept { return angular_velocity_radps_; }

  /// 6 x 6, row by row, as in nav_msgs/Odometry: x, y, z, then rotations about these axes. The
  /// variances of x, y and yaw only grow: nothing that the robot senses tells it where it is.
  std::array<double, 36> pose_covariance() const noexcept;
  std::array<double, 36> twist_covariance() const noexcept;

 private:
  bool has_last_ = false, walking_ = false;
  std::uint64_t last_tick_ = 0;
  Vector3 position_m_{};
  std::array<double, 4> orientation_wxyz_{1.0, 0.0, 0.0, 0.0};
  Vector3 velocity_mps_{};
  Vector3 angular_velocity_radps_{};
  double horizontal_variance_m2_ = 0.0, yaw_variance_rad2_ = 0.0;
};

/// Assumed errors: of the estimated velocity (standard deviation, correlated over a second), and
/// the drift of the IMU's yaw (random walk).
inline constexpr double kVelocityError_mps = 0.1;
inline constexpr double kVelocityErrorTime_s = 1.0;
inline constexpr double kYawWalk_radprts = 0.002;  ///< rad per square root of a second

}  // namespace sandrunner
