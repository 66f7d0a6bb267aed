// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "drivers/imu/mip.h"
#include "rt/core/messages.h"

namespace sandrunner {

/// What a MicroStrain accelerometer calls 1 g (3DM-GX5 DCP manual, "Scaled Accelerometer Vector").
inline constexpr double kStandardGravity_mps2 = 9.80665;

/// How the IMU sits on the robot, and with it the way from its axes and units to those of
/// ImuSample.
///
/// The sensor's own axes, which its case shows, are x forward, y right, z down (FRD), and its world
/// is north, east, down. Lying flat on the body, z down and x to the front, is the mounting
/// (1, 0, 0, 0): the same axes, named x forward, y left, z up (FLU), are then those of the body.
/// Any other mounting is the rotation that takes this pose to the real one, about the body's axes.
/// The world of the result is north, west, up.
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
  Vector3 to_body(const std::array<float, 3>& sensor) const noexcept;
  /// Rotation from body to world, unit quaternion, of the two signs the one nearer to `previous`. A
  /// `sensor_wxyz` that is no rotation (length off by more than 1 %) stays none.
  std::array<double, 4> to_orientation(const std::array<float, 4>& sensor_wxyz,
                                       const std::array<double, 4>& previous) const noexcept;

  /// What a sensor mounted so would send: acceleration, angular rate and quaternion. The way back,
  /// for a bench that plays the sensor.
  mip::SensorData to_sensor(const ImuSample& sample) const noexcept;

 private:
  std::array<double, 4> body_from_sensor_{1.0, 0.0, 0.0, 0.0};
};

}  // namespace sandrunner
