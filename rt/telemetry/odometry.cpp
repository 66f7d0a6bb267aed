// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/odometry.h"

namespace sandrunner {
namespace {

/// World x and y of a vector in the body frame.
std::array<double, 2> horizontal(const std::array<double, 4>& q, const Vector3& v) noexcept {
  const auto [w, x, y, z] = q;
  return {(1.0 - 2.0 * (y * y + z * z)) * v[0] + 2.0 * (x * y - w * z) * v[1] +
              2.0 * (x * z + w * y) * v[2],
          2.0 * (x * y + w * z) * v[0] + (1.0 - 2.0 * (x * x + z * z)) * v[1] +
              2.0 * (y * z - w * x) * v[2]};
}

}  // namespace

void Odometry::add(const TickRecord& tick) noexcept {
  const SensorFrame& sensors = tick.input.sensors;
  const double dt_s =
      has_last_ ? static_cast<double>(sensors.tick - last_tick_) * kControlPeriod_s : 0.0;
  has_last_ = true;
  last_tick_ = sensors.tick;
  orientation_wxyz_ = sensors.imu.orientation_wxyz;
  angular_velocity_radps_ = sensors.imu.angular_velocity_radps;
  yaw_variance_rad2_ += kYawWalk_radprts * kYawWalk_radprts * dt_s;

  walking_ = tick.output.mode == Mode::kWalk;
  const PolicyOutput& policy = tick.input.policy;
  const bool estimated =
      walking_ && policy.sequence != 0 && policy.episode == tick.output.policy_input.episode;
  velocity_mps_ = estimated ? policy.estimate.velocity_mps : Vector3{};
  if (!estimated) return;
  const auto [vx_mps, vy_mps] = horizontal(orientation_wxyz_, velocity_mps_);
  position_m_[0] += vx_mps * dt_s;
  position_m_[1] += vy_mps * dt_s;
  position_m_[2] = policy.estimate.body_height_m;
  horizontal_variance_m2_ += kVelocityError_mps * kVelocityError_mps * kVelocityErrorTime_s * dt_s;
}

std::array<double, 36> Odometry::pose_covariance() const noexcept {
  constexpr double kTilt_rad2 = 1e-4;
  constexpr double kUnknown = 1e6;  // so large that it means: not known
  std::array<double, 36> covariance{};
  covariance[0] = covariance[7] = horizontal_variance_m2_;
  covariance[14] = walking_ ? kVelocityError_mps * kVelocityError_mps : kUnknown;
  covariance[21] = covariance[28] = kTilt_rad2;
  covariance[35] = yaw_variance_rad2_;
  return covariance;
}

std::array<double, 36> Odometry::twist_covariance() const noexcept {
  constexpr double kTurn_radps2 = 1e-3;
  std::array<double, 36> covariance{};
  for (int i : {0, 7, 14}) covariance[i] = kVelocityError_mps * kVelocityError_mps;
  for (int i : {21, 28, 35}) covariance[i] = kTurn_radps2;
  return covariance;
}

}  // namespace sandrunner
