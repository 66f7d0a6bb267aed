// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/imu/imu_reading.h"

#include <algorithm>

namespace sandrunner {

namespace {

template <typename To, typename From, std::size_t kSize>
std::array<To, kSize> convert(const std::array<From, kSize>& from) noexcept {
  std::array<To, kSize> to;
  std::transform(from.begin(), from.end(), to.begin(), [](From x) { return static_cast<To>(x); });
  return to;
}

/// FRD to FLU, or NED to NWU, and back: half a turn about x. Of a quaternion between the two: both
/// of its sides.
Vector3 flip(const Vector3& v) noexcept { return {v[0], -v[1], -v[2]}; }
std::array<double, 4> flip(const std::array<double, 4>& q) noexcept {
  return {q[0], q[1], -q[2], -q[3]};
}

Vector3 scaled(const Vector3& v, double scale) noexcept {
  return {v[0] * scale, v[1] * scale, v[2] * scale};
}

}  // namespace

ImuReading to_reading(const mip::SensorData& data) noexcept {
  ImuReading reading;
  reading.device_ns = data.reference_time_ns;
  if (data.accel_g) {
    reading.acceleration_mps2 = scaled(flip(convert<double>(*data.accel_g)), kStandardGravity_mps2);
  }
  if (data.gyro_radps) reading.angular_velocity_radps = flip(convert<double>(*data.gyro_radps));
  // p_sensor = q^-1 p_ned q: it turns vectors from the sensor to the world, as here.
  if (data.quaternion_wxyz) reading.orientation_wxyz = flip(convert<double>(*data.quaternion_wxyz));
  return reading;
}

ImuReading to_reading(const xsens::SensorData& data) noexcept {
  ImuReading reading;
  if (data.acceleration_mps2) reading.acceleration_mps2 = convert<double>(*data.acceleration_mps2);
  if (data.rate_of_turn_radps) {
    reading.angular_velocity_radps = convert<double>(*data.rate_of_turn_radps);
  }
  if (data.quaternion_wxyz) reading.orientation_wxyz = convert<double>(*data.quaternion_wxyz);
  return reading;
}

mip::SensorData to_mip(const ImuReading& reading) noexcept {
  mip::SensorData data;
  data.reference_time_ns = reading.device_ns;
  if (reading.acceleration_mps2) {
    data.accel_g =
        convert<float>(scaled(flip(*reading.acceleration_mps2), 1.0 / kStandardGravity_mps2));
  }
  if (reading.angular_velocity_radps) {
    data.gyro_radps = convert<float>(flip(*reading.angular_velocity_radps));
  }
  if (reading.orientation_wxyz) {
    data.quaternion_wxyz = convert<float>(flip(*reading.orientation_wxyz));
  }
  return data;
}

xsens::SensorData to_xsens(const ImuReading& reading) noexcept {
  xsens::SensorData data;
  if (reading.device_ns) {
    data.sample_time =
        static_cast<std::uint32_t>(*reading.device_ns / xsens::SampleClock::kTick_ns);
  }
  if (reading.acceleration_mps2) {
    data.acceleration_mps2 = convert<float>(*reading.acceleration_mps2);
  }
  if (reading.angular_velocity_radps) {
    data.rate_of_turn_radps = convert<float>(*reading.angular_velocity_radps);
  }
  if (reading.orientation_wxyz) data.quaternion_wxyz = convert<float>(*reading.orientation_wxyz);
  return data;
}

}  // namespace sandrunner
