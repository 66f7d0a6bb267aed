// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "rt/core/messages.h"

namespace sandrunner {

/// What really is, as only a simulator can tell: for figures, pictures and comparison with the
/// estimate. The controller never sees it. World frame unless said otherwise.
struct RobotTruth {
  Vector3 position_m{};                                        ///< of the base origin
  std::array<double, 4> orientation_wxyz{1.0, 0.0, 0.0, 0.0};  ///< body to world
  Vector3 velocity_mps{};                                      ///< of the base origin
  Vector3 angular_velocity_radps{};                            ///< body frame
  JointArray<double> joint_position_rad{};
  JointArray<double> joint_velocity_radps{};
  JointArray<double> joint_torque_nm{};  ///< of the last step, after the drives' limits
  StateEstimate state;                   ///< what the network's estimate should be
  std::array<Vector3, kNumLegs> foot_centre_m{};
  /// Depth of each foot's deepest point below the undisturbed surface; below 0 in the air.
  std::array<double, kNumLegs> foot_penetration_m{};
  std::array<Vector3, kNumLegs> foot_force_n{};       ///< of the ground on the foot
  std::uint64_t base_contact = 0, thigh_contact = 0;  ///< 1: touches the ground
};
static_assert(std::is_trivially_copyable_v<RobotTruth>);
static_assert(sizeof(RobotTruth) ==
                  8 * (13 + 3 * kNumJoints + 1 + 3 + kNumLegs + kNumLegs * (3 + 1 + 3) + 2),
              "no padding");

}  // namespace sandrunner
