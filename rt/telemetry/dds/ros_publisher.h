// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "estimator/odometry.h"
#include "rt/core/robot_description.h"
#include "rt/dds/participant.h"
#include "rt/loop/tick_record.h"
#include "rt/telemetry/ros_messages.h"

namespace sandrunner {

/// Publishes the robot's state in ROS 2's messages: rt/joint_states, rt/imu/data, rt/odom, rt/tf,
/// rt/diagnostics, and once rt/robot_description and rt/tf_static.
class RosPublisher {
 public:
  /// Throws InputError.
  RosPublisher(const DdsParticipant& participant, const RobotDescription& robot);

  /// `stamp_ns` since 1970. Returns how many of the four messages could not be written.
  int publish(const TickRecord& tick, const Odometry& odometry, std::int64_t stamp_ns);
  /// False: it could not be written.
  bool publish(const DiagnosticsMessage& message);

 private:
  const RobotDescription robot_;
  const dds_entity_t joint_states_, imu_, odometry_, transforms_, diagnostics_;
};

/// Publishes the time of a simulation on rt/clock, for nodes with use_sim_time.
class ClockPublisher {
 public:
  /// Throws InputError.
  explicit ClockPublisher(const DdsParticipant& participant);

  /// `now_ns` since 1970. False: it could not be written.
  bool publish(std::int64_t now_ns);

 private:
  const dds_entity_t writer_;
};

}  // namespace sandrunner
