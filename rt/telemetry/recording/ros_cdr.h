// SPDX-License-Identifier: BSD-3-Clause
// The ROS 2 messages of a recording as bytes, and their schemas.
#pragma once

#include <string>

#include "rt/telemetry/recording/cdr.h"
#include "rt/telemetry/ros_messages.h"

namespace sandrunner {

/// One topic of a recording in ROS 2's own terms.
struct RosTopic {
  const char* topic;   ///< "/joint_states"
  const char* schema;  ///< "sensor_msgs/msg/JointState"
  std::string text;    ///< `ros2msg`: its definition and those of its parts
};

RosTopic joint_state_topic();
RosTopic imu_topic();
RosTopic odometry_topic();
RosTopic transform_topic();

CdrWriter cdr(const JointStateMessage& message);
CdrWriter cdr(const ImuMessage& message);
CdrWriter cdr(const OdometryMessage& message);
/// A tf2_msgs/TFMessage with this transform only.
CdrWriter cdr(const TransformMessage& message);

}  // namespace sandrunner
