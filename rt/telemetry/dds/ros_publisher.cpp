// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/dds/ros_publisher.h"

#include <algorithm>
#include <vector>

#include "rt/telemetry/dds/ros.h"
#include "rt/telemetry/dds/ros_time.h"

namespace sandrunner {
namespace {

constexpr int kDepth = 10;  // ROS 2's default

// The generated C structs know no const.
char* text(const char* constant) { return const_cast<char*>(constant); }

std_msgs_msg_dds__Header_ header(const RosHeader& h) {
  return {ros_time(h.stamp_ns), text(h.frame.c_str())};
}
geometry_msgs_msg_dds__Vector3_ vector3(const Vector3& v) { return {v[0], v[1], v[2]}; }
geometry_msgs_msg_dds__Quaternion_ quaternion(const std::array<double, 4>& q) {
  return {q[1], q[2], q[3], q[0]};
}
dds_sequence_double sequence(JointArray<double>& values) {
  return {kNumJoints, kNumJoints, values.data(), false};
}

bool write(dds_entity_t writer, JointStateMessage m) {
  JointArray<char*> names;
  for (int j = 0; j < kNumJoints; ++j) names[j] = m.names[j].data();
  const sensor_msgs_msg_dds__JointState_ message{
      .header = header(m.header),
      .name = {kNumJoints, kNumJoints, names.data(), false},
      .position = sequence(m.position),
      .velocity = sequence(m.velocity),
      .effort = sequence(m.effort)};
  return dds_write(writer, &message) >= 0;
}

bool write(dds_entity_t writer, const ImuMessage& m) {
  sensor_msgs_msg_dds__Imu_ message{};
  message.header = header(m.header);
  message.orientation = quaternion(m.orientation_wxyz);
  message.angular_velocity = vector3(m.angular_velocity);
  message.linear_acceleration = vector3(m.linear_acceleration);
  return dds_write(writer, &message) >= 0;
}

bool write(dds_entity_t writer, const OdometryMessage& m) {
  const Vector3& position = m.pose.translation;
  nav_msgs_msg_dds__Odometry_ message{};
  message.header = header(m.pose.header);
  message.child_frame_id = text(m.pose.child_frame.c_str());
  message.pose.pose.position = {position[0], position[1], position[2]};
  message.pose.pose.orientation = quaternion(m.pose.rotation_wxyz);
  message.twist.twist = {vector3(m.linear_velocity), vector3(m.angular_velocity)};
  std::ranges::copy(m.pose_covariance, message.pose.covariance);
  std::ranges::copy(m.twist_covariance, message.twist.covariance);
  return dds_write(writer, &message) >= 0;
}

bool write(dds_entity_t writer, const std::vector<TransformMessage>& m) {
  std::vector<geometry_msgs_msg_dds__TransformStamped_> transforms;
  for (const TransformMessage& t : m) {
    transforms.push_back({.header = header(t.header),
                          .child_frame_id = text(t.child_frame.c_str()),
                          .transform = {vector3(t.translation), quaternion(t.rotation_wxyz)}});
  }
  const auto size = static_cast<std::uint32_t>(transforms.size());
  const tf2_msgs_msg_dds__TFMessage_ message{{size, size, transforms.data(), false}};
  return dds_write(writer, &message) >= 0;
}

bool write(dds_entity_t writer, const DiagnosticsMessage& m) {
  std::vector<diagnostic_msgs_msg_dds__KeyValue_> pairs;
  for (const auto& [key, value] : m.values) {
    pairs.push_back({text(key.c_str()), text(value.c_str())});
  }
  const auto size = static_cast<std::uint32_t>(pairs.size());
  diagnostic_msgs_msg_dds__DiagnosticStatus_ status{.level = m.level,
                                                    .name = text(m.name.c_str()),
                                                    .message = text(m.message.c_str()),
                                                    .hardware_id = text(m.hardware_id.c_str()),
                                                    .values = {size, size, pairs.data(), false}};
  const diagnostic_msgs_msg_dds__DiagnosticArray_ message{header(m.header), {1, 1, &status, false}};
  return dds_write(writer, &message) >= 0;
}

}  // namespace

RosPublisher::RosPublisher(const DdsParticipant& participant, const RobotDescription& robot)
    : robot_(robot),
      joint_states_(
          participant.writer("rt/joint_states", sensor_msgs_msg_dds__JointState__desc, kDepth)),
      imu_(participant.writer("rt/imu/data", sensor_msgs_msg_dds__Imu__desc, kDepth)),
      odometry_(participant.writer("rt/odom", nav_msgs_msg_dds__Odometry__desc, kDepth)),
      transforms_(participant.writer("rt/tf", tf2_msgs_msg_dds__TFMessage__desc, kDepth)),
      diagnostics_(participant.writer("rt/diagnostics",
                                      diagnostic_msgs_msg_dds__DiagnosticArray__desc, kDepth)) {
  const dds_entity_t description =
      participant.writer("rt/robot_description", std_msgs_msg_dds__String__desc, 1, true);
  const std_msgs_msg_dds__String_ urdf{text(robot.ros_urdf.c_str())};
  check_dds(dds_write(description, &urdf), "rt/robot_description");
  // Holds at all times, whatever its stamp.
  const dds_entity_t fixed =
      participant.writer("rt/tf_static", tf2_msgs_msg_dds__TFMessage__desc, 1, true);
  check_dds(write(fixed, fixed_transforms(robot, 0)) ? DDS_RETCODE_OK : DDS_RETCODE_ERROR,
            "rt/tf_static");
}

int RosPublisher::publish(const TickRecord& tick, const Odometry& odometry, std::int64_t stamp_ns) {
  int failed = 0;
  failed += write(joint_states_, joint_state_message(tick, robot_, stamp_ns)) ? 0 : 1;
  failed += write(imu_, imu_message(tick, robot_, stamp_ns)) ? 0 : 1;
  failed += write(odometry_, odometry_message(odometry, robot_, stamp_ns)) ? 0 : 1;
  failed += write(transforms_, moving_transforms(tick, odometry, robot_, stamp_ns)) ? 0 : 1;
  return failed;
}

bool RosPublisher::publish(const DiagnosticsMessage& message) {
  return write(diagnostics_, message);
}

ClockPublisher::ClockPublisher(const DdsParticipant& participant)
    : writer_(participant.writer("rt/clock", rosgraph_msgs_msg_dds__Clock__desc, kDepth)) {}

bool ClockPublisher::publish(std::int64_t now_ns) {
  const rosgraph_msgs_msg_dds__Clock_ message{ros_time(now_ns)};
  return dds_write(writer_, &message) >= 0;
}

}  // namespace sandrunner
