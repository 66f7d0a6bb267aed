// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rt/core/messages.h"
#include "sim/simulator.h"

namespace sandrunner::hil {

/// The simulator's robot with the torques of drives outside of it. `sim::Simulator` takes a
/// SafeCommand and has the drives inside.
class EmulatedRobot {
 public:
  /// Lies on its belly.
  EmulatedRobot(const sim::Robot& robot, const sim::SimulatorConfig& config);

  /// One control tick under these torques.
  void step(const JointArray<double>& torque_nm) noexcept;

  const sim::RigidState<double>& state() const noexcept { return state_.rigid; }
  /// What its IMU feels: attitude, angular rate, specific force at the base origin.
  ImuSample imu() const noexcept;
  bool base_contact() const noexcept { return report_.base_contact > 0.0; }

 private:
  sim::Simulator simulator_;  ///< for its model and terrain alone
  sim::FootProfile<double> foot_;
  sim::StepSettings settings_;
  sim::RobotStepper<double> stepper_;
  sim::RobotState<double> state_;
  sim::StepReport<double> report_;
  sim::Footprints footprints_;  ///< of a terrain that keeps them
  Vector3 felt_mps2_{0.0, 0.0, kGravity_mps2};
};

}  // namespace sandrunner::hil
