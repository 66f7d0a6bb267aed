// SPDX-License-Identifier: BSD-3-Clause
// The sensors of a robot of a batch, and how they err: one model for trainings and evaluations.
// What errors a robot has, and how they are drawn, is theirs.
#pragma once

#include <array>
#include <cmath>

#include "sim/robot/dynamics.h"

namespace sandrunner::sim {

/// What the sensors of one robot report.
struct SensorReading {
  std::array<float, 3> up{};                ///< world z in the IMU's frame, unit vector
  std::array<float, 3> angular_velocity{};  ///< in the IMU's frame, rad/s
  JointArray<float> position{};             ///< rad
  JointArray<float> velocity{};             ///< rad/s
};

/// Errors that stay as they are during a run.
struct SensorErrors {
  JointArray<float> joint_offset_rad{};             ///< of each encoder
  float imu_roll_rad = 0.0f, imu_pitch_rad = 0.0f;  ///< how far the IMU is turned; small angles
};

/// Standard deviations of the noise; the defaults are those of trainings and evaluations
/// (recipe of tools/train/training.toml: twice those of its first run).
struct ObservationNoise {
  double gravity = 0.03;  ///< of each component of `up`
  double angular_velocity_radps = 0.1;
  double joint_position_rad = 0.02;
  double joint_velocity_radps = 0.3;
};

/// The reading without noise.
inline SensorReading read_sensors(const RigidState<float>& x, const SensorErrors& errors) {
  // From the body's frame to that of the IMU, to the first order of the angles.
  const float roll = errors.imu_roll_rad, pitch = errors.imu_pitch_rad;
  const auto in_imu = [&](const Vec3<float>& v) -> std::array<float, 3> {
    return {v.x - pitch * v.z, v.y + roll * v.z, v.z + pitch * v.x - roll * v.y};
  };
  SensorReading reading;
  reading.up = in_imu(rotation_matrix(x.orientation).r2);
  reading.angular_velocity = in_imu(x.angular_velocity);
  for (int j = 0; j < kNumJoints; ++j) reading.position[j] = x.q[j] + errors.joint_offset_rad[j];
  reading.velocity = x.qd;
  return reading;
}

/// Adds `draw(i, sigma)` to each value; `i` counts from 0 in the order of SensorReading. The calls
/// come joint by joint, a position and a velocity each.
template <typename Draw>
void add_noise(SensorReading& reading, const ObservationNoise& noise, const Draw& draw) {
  for (int i = 0; i < 3; ++i) reading.up[i] += draw(i, noise.gravity);
  const auto& [x, y, z] = reading.up;
  const float length = std::sqrt(x * x + y * y + z * z);
  for (float& u : reading.up) u /= length;
  for (int i = 0; i < 3; ++i) {
    reading.angular_velocity[i] += draw(3 + i, noise.angular_velocity_radps);
  }
  for (int j = 0; j < kNumJoints; ++j) {
    reading.position[j] += draw(6 + j, noise.joint_position_rad);
    reading.velocity[j] += draw(6 + kNumJoints + j, noise.joint_velocity_radps);
  }
}

}  // namespace sandrunner::sim
