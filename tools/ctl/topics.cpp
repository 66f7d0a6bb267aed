// SPDX-License-Identifier: BSD-3-Clause
#include "tools/ctl/topics.h"

#include <fmt/format.h>

#include <array>

#include "rt/base/errors.h"
#include "rt/telemetry/dds/tick_batches.h"
#include "tools/ctl/message_text.h"

namespace sandrunner::ctl {
namespace {

template <typename Message>
std::string text_of(const void* message) {
  return text(*static_cast<const Message*>(message));
}

constexpr int kDepth = 100;
const std::array<Topic, 11> kTopics = {{
    {"rt/joint_states", &sensor_msgs_msg_dds__JointState__desc, kDepth, false, false,
     text_of<sensor_msgs_msg_dds__JointState_>},
    {"rt/imu/data", &sensor_msgs_msg_dds__Imu__desc, kDepth, false, false,
     text_of<sensor_msgs_msg_dds__Imu_>},
    {"rt/odom", &nav_msgs_msg_dds__Odometry__desc, kDepth, false, false,
     text_of<nav_msgs_msg_dds__Odometry_>},
    {"rt/tf", &tf2_msgs_msg_dds__TFMessage__desc, kDepth, false, false,
     text_of<tf2_msgs_msg_dds__TFMessage_>},
    {"rt/tf_static", &tf2_msgs_msg_dds__TFMessage__desc, 1, true, true,
     text_of<tf2_msgs_msg_dds__TFMessage_>},
    {"rt/robot_description", &std_msgs_msg_dds__String__desc, 1, true, true,
     text_of<std_msgs_msg_dds__String_>},
    {"rt/diagnostics", &diagnostic_msgs_msg_dds__DiagnosticArray__desc, kDepth, false, false,
     text_of<diagnostic_msgs_msg_dds__DiagnosticArray_>},
    {"rt/cmd_vel", &geometry_msgs_msg_dds__Twist__desc, kDepth, false, false,
     text_of<geometry_msgs_msg_dds__Twist_>},
    {"sandrunner/ticks", &sandrunner_TickBatch_desc, kBatchDepth, true, false,
     text_of<sandrunner_TickBatch>},
    {"sandrunner/mode_request", &sandrunner_ModeRequest_desc, kDepth, true, false,
     text_of<sandrunner_ModeRequest>},
    {"sandrunner/mode_reply", &sandrunner_ModeReply_desc, kDepth, true, false,
     text_of<sandrunner_ModeReply>},
}};

}  // namespace

Topic find_topic(const std::string& name, const DdsConfig& config) {
  // ROS 2 calls rt/odom "/odom".
  const std::string dds_name = name.starts_with('/') ? "rt" + name : name;
  for (Topic topic : kTopics) {
    if (dds_name != topic.name) continue;
    if (config.stamped_cmd_vel && dds_name == "rt/cmd_vel") {
      topic.type = &geometry_msgs_msg_dds__TwistStamped__desc;
      topic.text = text_of<geometry_msgs_msg_dds__TwistStamped_>;
    }
    return topic;
  }
  throw InputError(fmt::format("watch: found '{}', expected {}", name, topic_names()));
}

std::string topic_names() {
  std::string names;
  for (const Topic& topic : kTopics) names += (names.empty() ? "" : ", ") + std::string(topic.name);
  return names;
}

}  // namespace sandrunner::ctl
