// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/ros_messages.h"

#include <algorithm>
#include <cstddef>

#include "rt/core/rotation.h"

namespace sandrunner {
namespace {

TransformMessage odometry_transform(const Odometry& odometry, const RobotDescription& robot,
                                    std::int64_t stamp_ns) {
  return {.header = {stamp_ns, kOdometryFrame},
          .child_frame = robot.base_frame,
          .translation = odometry.position_m(),
          .rotation_wxyz = odometry.orientation_wxyz()};
}

// `frame` in its parent's, with its joint, if it has one, turned by this angle.
TransformMessage frame_transform(const RobotFrame& frame, double angle_rad, std::int64_t stamp_ns) {
  return {.header = {stamp_ns, frame.parent},
          .child_frame = frame.name,
          .translation = frame.translation_m,
          .rotation_wxyz = turned(frame.rotation_wxyz, frame.axis, angle_rad)};
}

}  // namespace

void DiagnosticsMessage::warn(const std::string& what) {
  level = std::max(level, kWarning);
  message += ", " + what;
}

JointStateMessage joint_state_message(const TickRecord& tick, const RobotDescription& robot,
                                      std::int64_t stamp_ns) {
  const JointState& joints = tick.input.sensors.joints;
  return {.header = {stamp_ns, robot.base_frame},
          .names = robot.joint_names,
          .position = joints.position_rad,
          .velocity = joints.velocity_radps,
          .effort = joints.torque_nm};
}

ImuMessage imu_message(const TickRecord& tick, const RobotDescription& robot,
                       std::int64_t stamp_ns) {
  const ImuSample& imu = tick.input.sensors.imu;
  return {.header = {stamp_ns, robot.base_frame},
          .orientation_wxyz = imu.orientation_wxyz,
          .angular_velocity = imu.angular_velocity_radps,
          .linear_acceleration = imu.linear_acceleration_mps2};
}

OdometryMessage odometry_message(const Odometry& odometry, const RobotDescription& robot,
                                 std::int64_t stamp_ns) {
  return {.pose = odometry_transform(odometry, robot, stamp_ns),
          .pose_covariance = odometry.pose_covariance(),
          .linear_velocity = odometry.velocity_mps(),
          .angular_velocity = odometry.angular_velocity_radps(),
          .twist_covariance = odometry.twist_covariance()};
}

std::vector<TransformMessage> moving_transforms(const TickRecord& tick, const Odometry& odometry,
                                                const RobotDescription& robot,
                                                std::int64_t stamp_ns) {
  std::vector<TransformMessage> transforms{odometry_transform(odometry, robot, stamp_ns)};
  for (const RobotFrame& frame : robot.frames) {
    if (frame.joint < 0) continue;
    transforms.push_back(frame_transform(
        frame, tick.input.sensors.joints.position_rad[static_cast<std::size_t>(frame.joint)],
        stamp_ns));
  }
  return transforms;
}

std::vector<TransformMessage> fixed_transforms(const RobotDescription& robot,
                                               std::int64_t stamp_ns) {
  std::vector<TransformMessage> transforms;
  for (const RobotFrame& frame : robot.frames) {
    if (frame.joint < 0) transforms.push_back(frame_transform(frame, 0.0, stamp_ns));
  }
  return transforms;
}

}  // namespace sandrunner
