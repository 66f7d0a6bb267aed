// SPDX-License-Identifier: BSD-3-Clause
// What the robot's ROS 2 messages contain, however they are serialised: recordings
// (recording/ros_cdr.h) and DDS (dds/ros_publisher.h). Stamps are in ns since 1970, not negative.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "estimator/odometry.h"
#include "rt/core/robot_description.h"
#include "rt/loop/tick_record.h"

namespace sandrunner {

/// Frame in which the odometry starts above the origin.
inline constexpr const char* kOdometryFrame = "odom";

/// std_msgs/Header.
struct RosHeader {
  std::int64_t stamp_ns = 0;
  std::string frame;
};

/// sensor_msgs/JointState: rad, rad/s, Nm.
struct JointStateMessage {
  RosHeader header;
  JointArray<std::string> names;
  JointArray<double> position, velocity, effort;
};

/// sensor_msgs/Imu, body frame. Its covariances are all zero, which in ROS means: not known.
struct ImuMessage {
  RosHeader header;
  std::array<double, 4> orientation_wxyz;
  Vector3 angular_velocity, linear_acceleration;
};

/// geometry_msgs/TransformStamped: where the child frame is in the header's.
struct TransformMessage {
  RosHeader header;
  std::string child_frame;
  Vector3 translation;
  std::array<double, 4> rotation_wxyz;
};

/// nav_msgs/Odometry: the pose as in the transform, the twist in the child frame.
struct OdometryMessage {
  TransformMessage pose;
  std::array<double, 36> pose_covariance;
  Vector3 linear_velocity, angular_velocity;
  std::array<double, 36> twist_covariance;
};

/// diagnostic_msgs/DiagnosticArray with one status.
struct DiagnosticsMessage {
  enum Level : std::uint8_t { kOk = 0, kWarning = 1, kError = 2 };  // DiagnosticStatus

  RosHeader header;
  Level level = kOk;
  std::string name, message, hardware_id;
  std::vector<std::pair<std::string, std::string>> values;

  /// Adds something that an operator should look at.
  void warn(const std::string& what);
};

JointStateMessage joint_state_message(const TickRecord& tick, const RobotDescription& robot,
                                      std::int64_t stamp_ns);
ImuMessage imu_message(const TickRecord& tick, const RobotDescription& robot,
                       std::int64_t stamp_ns);
OdometryMessage odometry_message(const Odometry& odometry, const RobotDescription& robot,
                                 std::int64_t stamp_ns);
/// For /tf: the base in the frame "odom", and every link that a joint turns.
std::vector<TransformMessage> moving_transforms(const TickRecord& tick, const Odometry& odometry,
                                                const RobotDescription& robot,
                                                std::int64_t stamp_ns);
/// For /tf_static: every other link.
std::vector<TransformMessage> fixed_transforms(const RobotDescription& robot,
                                               std::int64_t stamp_ns);

}  // namespace sandrunner
