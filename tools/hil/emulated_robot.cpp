// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/emulated_robot.h"

#include <algorithm>

namespace sandrunner::hil {
namespace {

/// Of the contact solver: a robot that lies on base, knees and feet would take longer than a tick
/// on the emulated machine.
constexpr int kMostSweeps = 20;

}  // namespace

EmulatedRobot::EmulatedRobot(const sim::Robot& robot, const sim::SimulatorConfig& config)
    : simulator_(robot, config),
      foot_(make_foot_profile(config.terrain, robot.model)),
      settings_(config.step) {
  settings_.max_sweeps = std::min(settings_.max_sweeps, kMostSweeps);
  simulator_.reset_lying();
  state_ = simulator_.state().robot;
}

void EmulatedRobot::step(const JointArray<double>& torque_nm) noexcept {
  const sim::Mat3<double> before = rotation_matrix(state_.rigid.orientation);
  stepper_.step(simulator_.model(), foot_, simulator_.terrain(), settings_, torque_nm, state_,
                report_, simulator_.relief(), {{&footprints_}});
  const sim::Vec3<double> felt = mul_add(before.r2, kGravity_mps2, report_.base_acceleration);
  felt_mps2_ = {felt.x, felt.y, felt.z};
}

ImuSample EmulatedRobot::imu() const noexcept {
  const sim::RigidState<double>& x = state_.rigid;
  ImuSample imu;
  imu.orientation_wxyz = {x.orientation.w, x.orientation.x, x.orientation.y, x.orientation.z};
  imu.angular_velocity_radps = {x.angular_velocity.x, x.angular_velocity.y, x.angular_velocity.z};
  imu.linear_acceleration_mps2 = felt_mps2_;
  return imu;
}

}  // namespace sandrunner::hil
