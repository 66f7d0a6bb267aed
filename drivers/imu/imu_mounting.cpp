// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/imu/imu_mounting.h"

#include <fmt/format.h>

#include <cmath>

#include "rt/base/errors.h"
#include "rt/core/rotation.h"

namespace sandrunner {

namespace {

/// Whether it is a rotation, to 1 %; only then is it given the length 1.
bool normalise(Rotation& q) noexcept {
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(std::abs(norm - 1.0) <= 0.01)) return false;
  for (double& number : q) number /= norm;
  return true;
}

}  // namespace

ImuMounting::ImuMounting(const Rotation& body_from_sensor_wxyz)
    : body_from_sensor_(body_from_sensor_wxyz) {
  const Rotation& q = body_from_sensor_wxyz;
  if (!normalise(body_from_sensor_)) {
    throw InputError(
        fmt::format("IMU mounting: ({}, {}, {}, {}) is no rotation: expected a quaternion "
                    "(w, x, y, z) of length 1",
                    q[0], q[1], q[2], q[3]));
  }
}

ImuMounting ImuMounting::from_rpy(const Vector3& rpy_rad) {
  if (!all_finite(rpy_rad)) {
    throw InputError(fmt::format("IMU mounting: roll, pitch, yaw ({}, {}, {}) must be finite",
                                 rpy_rad[0], rpy_rad[1], rpy_rad[2]));
  }
  const auto about = [&rpy_rad](std::size_t axis) {
    Rotation q{std::cos(rpy_rad[axis] / 2), 0.0, 0.0, 0.0};
    q[axis + 1] = std::sin(rpy_rad[axis] / 2);
    return q;
  };
  return ImuMounting(product(product(about(2), about(1)), about(0)));
}

Vector3 ImuMounting::to_body(const Vector3& sensor) const noexcept {
  return rotated(body_from_sensor_, sensor);
}

Rotation ImuMounting::to_orientation(const Rotation& sensor_wxyz,
                                     const Rotation& previous) const noexcept {
  Rotation q = product(sensor_wxyz, inverse(body_from_sensor_));
  normalise(q);
  double dot = 0.0;
  for (std::size_t i = 0; i < q.size(); ++i) dot += q[i] * previous[i];
  if (dot < 0.0) {
    for (double& number : q) number = -number;
  }
  return q;
}

ImuReading ImuMounting::to_sensor(const ImuSample& sample) const noexcept {
  const Rotation sensor_from_body = inverse(body_from_sensor_);
  ImuReading reading;
  reading.acceleration_mps2 = rotated(sensor_from_body, sample.linear_acceleration_mps2);
  reading.angular_velocity_radps = rotated(sensor_from_body, sample.angular_velocity_radps);
  reading.orientation_wxyz = product(sample.orientation_wxyz, body_from_sensor_);
  return reading;
}

}  // namespace sandrunner
