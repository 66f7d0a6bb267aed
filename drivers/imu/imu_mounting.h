// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "drivers/imu/imu_reading.h"
#include "rt/core/messages.h"

namespace sandrunner {

/// How the IMU sits on the robot: from its axes to the body's (imu_reading.h).
///
/// The axes that a sensor's case shows are x forward, y left, z up (Xsens), or x forward, y right,
/// z down (MicroStrain). Lying flat on the body, x to the front, and z up or down as the case shows
/// it, is the mounting (1, 0, 0, 0): the sensor's axes, named x forward, y left, z up (FLU), are
/// then those of the body. Any other mounting is the rotation that takes this pose to the real one,
/// about the body's axes. The world of the result is north, west, up.
///
/// Only turned, not moved: the acceleration stays that of the sensor's place. Away from the base
/// origin by r it holds centripetal and tangential parts, w x (w x r) + dw/dt x r.
class ImuMounting {
 public:
  /// Flat, x to the front.
  ImuMounting() = default;
  /// Rotation from the sensor's axes, named as FLU, to the body's: (w, x, y, z). InputError if that
  /// is no unit quaternion (to 1 %); normalised.
  explicit ImuMounting(const std::array<double, 4>& body_from_sensor_wxyz);
  /// The sensor is turned by yaw about the body's z, then by pitch about its own y, then by roll
  /// about its own x. InputError if not finite.
  static ImuMounting from_rpy(const Vector3& rpy_rad);

  /// A sensor's vector in the body frame; its unit stays.
  Vector3 to_body(const Vector3& sensor) const noexcept;
  /// Rotation from body to world, unit quaternion, of the two signs the one nearer to `previous`. A
  /// `sensor_wxyz` that is no rotation (length off by more than 1 %) stays none.
  std::array<double, 4> to_orientation(const std::array<double, 4>& sensor_wxyz,
                                       const std::array<double, 4>& previous) const noexcept;

  /// What a sensor mounted so would measure, without its clock. The way back, for a bench that
  /// plays the sensor.
  ImuReading to_sensor(const ImuSample& sample) const noexcept;

 private:
  std::array<double, 4> body_from_sensor_{1.0, 0.0, 0.0, 0.0};
};

}  // namespace sandrunner
