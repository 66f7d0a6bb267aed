// SPDX-License-Identifier: BSD-3-Clause
// The ROS 2 messages of a recording: schema texts and contents.
#pragma once

#include <cstdint>
#include <string>

#include "rt/loop/tick_record.h"
#include "rt/telemetry/odometry.h"
#include "rt/telemetry/recording/cdr.h"

namespace sandrunner {

/// One topic of a recording in ROS 2's own terms.
struct RosTopic {
  const char* topic;   ///< "/joint_states"
  const char* schema;  ///< "sensor_msgs/msg/JointState"
  std::string text;    ///< `ros2msg`: definition and those of its parts
};

RosTopic joint_state_topic();
RosTopic imu_topic();
RosTopic odometry_topic();
RosTopic transform_topic();

// Contents at a tick; `time_ns` since 1970.
CdrWriter joint_state_message(const TickRecord& tick, std::int64_t time_ns);
CdrWriter imu_message(const TickRecord& tick, std::int64_t time_ns);
CdrWriter odometry_message(const Odometry& odometry, std::int64_t time_ns);
CdrWriter transform_message(const Odometry& odometry, std::int64_t time_ns);

}  // namespace sandrunner
