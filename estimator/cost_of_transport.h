// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "rt/core/messages.h"

namespace sandrunner {

/// Torques of HAA, HFE and KFE times these factors heat as much as they would in a drive of the
/// HAA: k_m of HAA over that of each. All are 1 where the drives are alike.
template <typename S>
LegJoints<S> heat_factors(const LegJoints<double>& motor_constant) noexcept {
  LegJoints<S> factors;
  for (int j = 0; j < kJointsPerLeg; ++j) {
    const bool alike = motor_constant[j] == motor_constant[0];
    factors[j] = alike ? S(1.0) : S(motor_constant[0] / motor_constant[j]);
  }
  return factors;
}

/// What the cost of transport takes of a robot.
struct Drivetrain {
  double mass_kg = 0.0;
  double motor_constant = 0.0;  ///< k_m of HAA, N m/sqrt(W) at the joint
};

/// (P_mech + P_heat)/(m g v) with P_heat = sum tau^2/k_m^2 (paper, "Beach sand"); none below
/// 0.05 m/s. `mechanical_w`, `torque_squared_nm2`: means of the sums over joints of tau qd
/// and of tau^2, with tau times its heat factor.
inline std::optional<double> cost_of_transport(double mechanical_w, double torque_squared_nm2,
                                               double speed_mps, const Drivetrain& robot) noexcept {
  constexpr double kSlowest_mps = 0.05;
  if (!(speed_mps >= kSlowest_mps)) return std::nullopt;
  const double heat_w = torque_squared_nm2 / (robot.motor_constant * robot.motor_constant);
  return (mechanical_w + heat_w) / (robot.mass_kg * kGravity_mps2 * speed_mps);
}

}  // namespace sandrunner
