// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "rt/loop/tick_record.h"
#include "rt/telemetry/dds/participant.h"
#include "rt/telemetry/odometry.h"

namespace sandrunner {

/// Publishes the robot's state in ROS 2's messages: rt/joint_states, rt/imu/data, rt/odom, rt/tf
/// (odom to base), and once rt/robot_description.
class RosPublisher {
 public:
  /// `robot_description`: URDF whose base link is "base". Throws InputError.
  RosPublisher(const DdsParticipant& participant, const std::string& robot_description);
  ~RosPublisher();

  /// `stamp_ns` since 1970. Returns how many of the four messages could not be written.
  int publish(const TickRecord& tick, const Odometry& odometry, std::int64_t stamp_ns);

 private:
  struct Messages;
  std::unique_ptr<Messages> messages_;
};

}  // namespace sandrunner
