// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "estimator/heading.h"
#include "rt/core/messages.h"
#include "rt/core/rotation.h"

namespace sandrunner {

/// How the base moves as a command has it.
struct BodyMotion {
  double vx_mps = 0.0, vy_mps = 0.0;  ///< heading frame
  double yaw_rate_radps = 0.0;        ///< about world z
};

/// From the velocity in the world frame and the angular velocity in the body frame.
inline BodyMotion body_motion(const Rotation& orientation_wxyz, const Vector3& velocity_mps,
                              const Vector3& angular_velocity_radps) noexcept {
  const std::array<Vector3, 3> axes = body_axes(orientation_wxyz);
  const auto [vx_mps, vy_mps] =
      in_heading_frame<double>({axes[0][0], axes[0][1]}, {velocity_mps[0], velocity_mps[1]});
  return {vx_mps, vy_mps, to_world(axes, angular_velocity_radps)[2]};
}

}  // namespace sandrunner
