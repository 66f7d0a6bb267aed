// SPDX-License-Identifier: BSD-3-Clause
// Messages as readable text, one line each. Control characters in text from others are removed.
#pragma once

#include <string>

#include "rt/telemetry/dds/ros.h"
#include "rt/telemetry/dds/sandrunner.h"

namespace sandrunner::ctl {

/// Name of a mode from its number in a message.
const char* mode_text(std::uint32_t mode);

std::string text(const sensor_msgs_msg_dds__JointState_& m);
std::string text(const sensor_msgs_msg_dds__Imu_& m);
std::string text(const nav_msgs_msg_dds__Odometry_& m);
std::string text(const tf2_msgs_msg_dds__TFMessage_& m);
std::string text(const std_msgs_msg_dds__String_& m);
std::string text(const diagnostic_msgs_msg_dds__DiagnosticArray_& m);
std::string text(const geometry_msgs_msg_dds__Twist_& m);
std::string text(const geometry_msgs_msg_dds__TwistStamped_& m);
std::string text(const sandrunner_TickBatch& m);
std::string text(const sandrunner_ModeRequest& m);
std::string text(const sandrunner_ModeReply& m);

}  // namespace sandrunner::ctl
