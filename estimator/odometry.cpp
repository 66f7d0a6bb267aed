// SPDX-License-Identifier: BSD-3-Clause
#include "estimator/odometry.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "rt/core/rotation.h"

namespace sandrunner {
namespace {

// Standard deviations of the errors, assumed and compared with the simulator's truth in
// odometry_test.cpp.
constexpr double kNetworkVelocity_mps = 0.2;
constexpr double kStillVelocity_mps = 0.03;
constexpr double kNetworkHeight_m = 0.05;
constexpr double kJointsHeight_m = 0.04;   // the feet sink into sand
constexpr double kUnknownHeight_m = 0.15;  // the lowest part need not touch the ground
constexpr double kTilt_rad = 0.01;
constexpr double kTurn_radps = 0.03;
/// Time over which an error of the velocity stays the same.
constexpr double kVelocityErrorTime_s = 1.0;
/// Speed of a robot that stands up or falls.
constexpr double kUnknownSpeed_mps = 0.5;
/// Drift of the IMU's yaw, rad per square root of a second.
constexpr double kYawWalk_radprts = 0.002;

// Still is a robot of which nothing has moved for this long: no joint turns faster than this, no
// axis of the body, and the accelerometer, smoothed, shows gravity only.
constexpr std::uint64_t kStill_ticks = kControlHz / 4;
constexpr double kStillJoint_radps = 0.2;
constexpr double kStillTurn_radps = 0.1;
constexpr double kStillAcceleration_mps2 = 0.5;
constexpr double kAccelerationTime_s = 0.05;

// How the height follows what is measured: with this time constant, but not faster than this.
constexpr double kHeightTime_s = 0.1;
constexpr double kHeightSpeed_mps = 1.0;

void set_diagonal(std::array<double, 36>& covariance, std::size_t first, const Vector3& variances) {
  for (std::size_t i = 0; i < 3; ++i) covariance[7 * (first + i)] = variances[i];
}

}  // namespace

Odometry::Odometry(const RobotDescription& robot) : kinematics_(robot) {}

void Odometry::add(const ControllerInput& input, const ControllerOutput& output) noexcept {
  const SensorFrame& sensors = input.sensors;
  const double dt_s =
      has_last_ ? static_cast<double>(sensors.tick - last_tick_) * kControlPeriod_s : 0.0;
  if (!has_last_) restless_tick_ = sensors.tick;
  last_tick_ = sensors.tick;
  if (all_finite(sensors.imu.orientation_wxyz)) orientation_wxyz_ = sensors.imu.orientation_wxyz;
  angular_velocity_radps_ = sensors.imu.angular_velocity_radps;
  yaw_variance_rad2_ += kYawWalk_radprts * kYawWalk_radprts * dt_s;

  if (moves(sensors, dt_s)) restless_tick_ = sensors.tick;
  source_ = source_of(input, output);
  const StateEstimate& estimate = input.policy.estimate;
  velocity_mps_ = source_ == Source::kNetwork ? estimate.velocity_mps : Vector3{};
  const Vector3 velocity_mps = rotated(orientation_wxyz_, velocity_mps_);
  position_m_[0] += velocity_mps[0] * dt_s;
  position_m_[1] += velocity_mps[1] * dt_s;
  const double error_mps = source_ == Source::kNetwork ? kNetworkVelocity_mps
                           : source_ == Source::kStill ? 0.0
                                                       : kUnknownSpeed_mps;
  horizontal_variance_m2_ += error_mps * error_mps * kVelocityErrorTime_s * dt_s;
  const bool knows_height = source_ == Source::kNetwork && std::isfinite(estimate.body_height_m);
  follow_height(
      knows_height ? estimate.body_height_m : height_by_joints_m(sensors.joints.position_rad),
      dt_s);
  has_last_ = true;
}

bool Odometry::moves(const SensorFrame& sensors, double dt_s) noexcept {
  const double excess_mps2 = length(sensors.imu.linear_acceleration_mps2) - kGravity_mps2;
  if (std::isfinite(excess_mps2)) {
    acceleration_mps2_ +=
        (excess_mps2 - acceleration_mps2_) * std::min(dt_s / kAccelerationTime_s, 1.0);
  }
  const bool joints_rest = std::ranges::all_of(
      sensors.joints.velocity_radps,
      [](double speed_radps) { return std::fabs(speed_radps) <= kStillJoint_radps; });
  return !(joints_rest && length(sensors.imu.angular_velocity_radps) <= kStillTurn_radps &&
           std::fabs(acceleration_mps2_) <= kStillAcceleration_mps2);
}

Odometry::Source Odometry::source_of(const ControllerInput& input,
                                     const ControllerOutput& output) const noexcept {
  const PolicyOutput& policy = input.policy;
  if (output.mode == Mode::kWalk && policy.sequence != 0 &&
      policy.episode == output.policy_input.episode && all_finite(policy.estimate.velocity_mps)) {
    return Source::kNetwork;
  }
  return last_tick_ - restless_tick_ >= kStill_ticks ? Source::kStill : Source::kNone;
}

double Odometry::height_by_joints_m(const JointArray<double>& position_rad) noexcept {
  kinematics_.place({.position_m = {}, .rotation_wxyz = orientation_wxyz_}, position_rad);
  return -kinematics_.lowest_m();
}

void Odometry::follow_height(double height_m, double dt_s) noexcept {
  if (!std::isfinite(height_m)) return;
  const double error_m = height_m - position_m_[2];
  const double most_m = has_last_ ? kHeightSpeed_mps * dt_s : std::fabs(error_m);
  const double step_m = has_last_ ? error_m * std::min(dt_s / kHeightTime_s, 1.0) : error_m;
  position_m_[2] += std::clamp(step_m, -most_m, most_m);
}

std::array<double, 36> Odometry::pose_covariance() const noexcept {
  const double height_m = source_ == Source::kNetwork ? kNetworkHeight_m
                          : source_ == Source::kStill ? kJointsHeight_m
                                                      : kUnknownHeight_m;
  std::array<double, 36> covariance{};
  set_diagonal(covariance, 0,
               {horizontal_variance_m2_, horizontal_variance_m2_, height_m * height_m});
  set_diagonal(covariance, 3, {kTilt_rad * kTilt_rad, kTilt_rad * kTilt_rad, yaw_variance_rad2_});
  return covariance;
}

std::array<double, 36> Odometry::twist_covariance() const noexcept {
  const double velocity = source_ == Source::kNetwork ? kNetworkVelocity_mps * kNetworkVelocity_mps
                          : source_ == Source::kStill ? kStillVelocity_mps * kStillVelocity_mps
                                                      : kUnknownVariance;
  constexpr double kTurn = kTurn_radps * kTurn_radps;
  std::array<double, 36> covariance{};
  set_diagonal(covariance, 0, {velocity, velocity, velocity});
  set_diagonal(covariance, 3, {kTurn, kTurn, kTurn});
  return covariance;
}

}  // namespace sandrunner
