// SPDX-License-Identifier: BSD-3-Clause
// The ROS 2 messages of a recording as bytes.
#pragma once

#include <string>
#include <vector>

#include "rt/telemetry/recording/cdr.h"
#include "rt/telemetry/ros_messages.h"

namespace sandrunner {

CdrWriter cdr(const JointStateMessage& message);
CdrWriter cdr(const ImuMessage& message);
CdrWriter cdr(const OdometryMessage& message);
CdrWriter cdr(const std::vector<TransformMessage>& transforms);
CdrWriter cdr(const DiagnosticsMessage& message);
/// A std_msgs/String.
CdrWriter cdr(const std::string& text);

}  // namespace sandrunner
