// SPDX-License-Identifier: BSD-3-Clause
// The one observation function: robot, simulator and training all build the network's input here,
// because the commonest error between simulation and robot is that there are two of them.
#pragma once

#include <array>

#include "rt/core/messages.h"

namespace sandrunner {

/// The network's raw input, 33 numbers (paper, "Controller structure"; order of the authors'
/// published controller): command vx, vy (m/s), yaw rate (rad/s) | world z axis in the body frame |
/// base angular velocity, body frame (rad/s) | 12 joint positions, absolute (rad) | 12 joint
/// velocities (rad/s). Not normalised: that belongs to the policy. `T` holds a number of one robot;
/// `up` is the third row of the rotation from body to world.
template <typename T>
inline std::array<T, kObservationSize> make_observation(const std::array<T, 3>& command,
                                                        const std::array<T, 3>& up,
                                                        const std::array<T, 3>& angular_velocity,
                                                        const JointArray<T>& position,
                                                        const JointArray<T>& velocity) noexcept {
  std::array<T, kObservationSize> o;
  for (int i = 0; i < 3; ++i) {
    o[i] = command[i];
    o[3 + i] = up[i];
    o[6 + i] = angular_velocity[i];
  }
  for (int j = 0; j < kNumJoints; ++j) {
    o[9 + j] = position[j];
    o[9 + kNumJoints + j] = velocity[j];
  }
  return o;
}

/// World z axis in the body frame from a unit quaternion (w, x, y, z), body to world.
inline std::array<double, 3> up_in_body(const std::array<double, 4>& q) noexcept {
  return {2.0 * (q[1] * q[3] - q[0] * q[2]), 2.0 * (q[2] * q[3] + q[0] * q[1]),
          1.0 - 2.0 * (q[1] * q[1] + q[2] * q[2])};
}

/// The observation of one policy input.
inline std::array<float, kObservationSize> make_observation(const PolicyInput& in) noexcept {
  const std::array<double, kObservationSize> o =
      make_observation<double>({in.command.vx_mps, in.command.vy_mps, in.command.wz_radps},
                               up_in_body(in.imu.orientation_wxyz), in.imu.angular_velocity_radps,
                               in.joints.position_rad, in.joints.velocity_radps);
  std::array<float, kObservationSize> out;
  for (int i = 0; i < kObservationSize; ++i) out[i] = static_cast<float>(o[i]);
  return out;
}

}  // namespace sandrunner
