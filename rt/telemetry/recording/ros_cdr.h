// SPDX-License-Identifier: BSD-3-Clause
// The ROS 2 messages of a recording as bytes, and their schemas.
#pragma once

#include <string>
#include <vector>

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
RosTopic transforms_topic();         ///< "/tf"
RosTopic fixed_transforms_topic();   ///< "/tf_static"
RosTopic robot_description_topic();  ///< a std_msgs/String
RosTopic diagnostics_topic();

CdrWriter cdr(const JointStateMessage& message);
CdrWriter cdr(const ImuMessage& message);
CdrWriter cdr(const OdometryMessage& message);
CdrWriter cdr(const std::vector<TransformMessage>& transforms);
CdrWriter cdr(const DiagnosticsMessage& message);
/// A std_msgs/String.
CdrWriter cdr(const std::string& text);

}  // namespace sandrunner
