// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/dds/ros_publisher.h"

#include <algorithm>

#include "rt/telemetry/dds/ros.h"
#include "rt/telemetry/dds/ros_time.h"

namespace sandrunner {
namespace {

constexpr int kDepth = 10;  // what a ROS 2 publisher has unless told otherwise

// The generated C structs have no const.
char* text(const char* constant) { return const_cast<char*>(constant); }

geometry_msgs_msg_dds__Vector3_ vector3(const Vector3& v) { return {v[0], v[1], v[2]}; }
geometry_msgs_msg_dds__Quaternion_ quaternion(const std::array<double, 4>& q) {
  return {q[1], q[2], q[3], q[0]};
}

}  // namespace

struct RosPublisher::Messages {
  dds_entity_t joint_states_writer, imu_writer, odom_writer, tf_writer;
  sensor_msgs_msg_dds__JointState_ joint_states{};
  sensor_msgs_msg_dds__Imu_ imu{};
  nav_msgs_msg_dds__Odometry_ odom{};
  geometry_msgs_msg_dds__TransformStamped_ base{};
  tf2_msgs_msg_dds__TFMessage_ tf{};
  // What the messages point to.
  std::array<char*, kNumJoints> names{};
  JointArray<double> position{}, velocity{}, effort{};

  Messages() {
    for (int j = 0; j < kNumJoints; ++j) names[j] = text(kJointNames[j]);
    constexpr std::uint32_t kCount = kNumJoints;
    joint_states.header.frame_id = text(kBaseFrame);
    joint_states.name = {kCount, kCount, names.data(), false};
    joint_states.position = {kCount, kCount, position.data(), false};
    joint_states.velocity = {kCount, kCount, velocity.data(), false};
    joint_states.effort = {kCount, kCount, effort.data(), false};
    imu.header.frame_id = text(kBaseFrame);
    odom.header.frame_id = text(kOdomFrame);
    odom.child_frame_id = text(kBaseFrame);
    base.header.frame_id = text(kOdomFrame);
    base.child_frame_id = text(kBaseFrame);
    tf.transforms = {1, 1, &base, false};
  }
};

RosPublisher::RosPublisher(const DdsParticipant& participant, const std::string& robot_description)
    : messages_(std::make_unique<Messages>()) {
  Messages& m = *messages_;
  m.joint_states_writer =
      participant.writer("rt/joint_states", sensor_msgs_msg_dds__JointState__desc, kDepth);
  m.imu_writer = participant.writer("rt/imu/data", sensor_msgs_msg_dds__Imu__desc, kDepth);
  m.odom_writer = participant.writer("rt/odom", nav_msgs_msg_dds__Odometry__desc, kDepth);
  m.tf_writer = participant.writer("rt/tf", tf2_msgs_msg_dds__TFMessage__desc, kDepth);
  const dds_entity_t description =
      participant.writer("rt/robot_description", std_msgs_msg_dds__String__desc, 1, true);
  const std_msgs_msg_dds__String_ urdf{text(robot_description.c_str())};
  check_dds(dds_write(description, &urdf), "rt/robot_description");
}

RosPublisher::~RosPublisher() = default;

int RosPublisher::publish(const TickRecord& tick, const Odometry& odometry, std::int64_t stamp_ns) {
  Messages& m = *messages_;
  const builtin_interfaces_msg_dds__Time_ stamp = ros_time(stamp_ns);
  const SensorFrame& sensors = tick.input.sensors;

  m.joint_states.header.stamp = stamp;
  m.position = sensors.joints.position_rad;
  m.velocity = sensors.joints.velocity_radps;
  m.effort = sensors.joints.torque_nm;

  // The covariances stay zero, which in ROS means: not known.
  m.imu.header.stamp = stamp;
  m.imu.orientation = quaternion(sensors.imu.orientation_wxyz);
  m.imu.angular_velocity = vector3(sensors.imu.angular_velocity_radps);
  m.imu.linear_acceleration = vector3(sensors.imu.linear_acceleration_mps2);

  const Vector3& position_m = odometry.position_m();
  m.odom.header.stamp = stamp;
  m.odom.pose.pose.position = {position_m[0], position_m[1], position_m[2]};
  m.odom.pose.pose.orientation = quaternion(odometry.orientation_wxyz());
  m.odom.twist.twist.linear = vector3(odometry.velocity_mps());
  m.odom.twist.twist.angular = vector3(odometry.angular_velocity_radps());
  std::ranges::copy(odometry.pose_covariance(), m.odom.pose.covariance);
  std::ranges::copy(odometry.twist_covariance(), m.odom.twist.covariance);

  m.base.header.stamp = stamp;
  m.base.transform.translation = vector3(position_m);
  m.base.transform.rotation = m.odom.pose.pose.orientation;

  int failed = 0;
  failed += dds_write(m.joint_states_writer, &m.joint_states) < 0 ? 1 : 0;
  failed += dds_write(m.imu_writer, &m.imu) < 0 ? 1 : 0;
  failed += dds_write(m.odom_writer, &m.odom) < 0 ? 1 : 0;
  failed += dds_write(m.tf_writer, &m.tf) < 0 ? 1 : 0;
  return failed;
}

}  // namespace sandrunner
