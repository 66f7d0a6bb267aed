// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/ros_messages.h"

namespace sandrunner {

JointStateMessage joint_state_message(const TickRecord& tick, const RobotDescription& robot,
                                      std::int64_t stamp_ns) {
  const JointState& joints = tick.input.sensors.joints;
  return {.header = {stamp_ns, robot.base_link},
          .names = robot.joint_names,
          .position = joints.position_rad,
          .velocity = joints.velocity_radps,
          .effort = joints.torque_nm};
}

ImuMessage imu_message(const TickRecord& tick, const RobotDescription& robot,
                       std::int64_t stamp_ns) {
  const ImuSample& imu = tick.input.sensors.imu;
  return {.header = {stamp_ns, robot.base_link},
          .orientation_wxyz = imu.orientation_wxyz,
          .angular_velocity = imu.angular_velocity_radps,
          .linear_acceleration = imu.linear_acceleration_mps2};
}

TransformMessage transform_message(const Odometry& odometry, const RobotDescription& robot,
                                   std::int64_t stamp_ns) {
  return {.header = {stamp_ns, kOdometryFrame},
          .child_frame = robot.base_link,
          .translation = odometry.position_m(),
          .rotation_wxyz = odometry.orientation_wxyz()};
}

OdometryMessage odometry_message(const Odometry& odometry, const RobotDescription& robot,
                                 std::int64_t stamp_ns) {
  return {.pose = transform_message(odometry, robot, stamp_ns),
          .pose_covariance = odometry.pose_covariance(),
          .linear_velocity = odometry.velocity_mps(),
          .angular_velocity = odometry.angular_velocity_radps(),
          .twist_covariance = odometry.twist_covariance()};
}

}  // namespace sandrunner
