// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/recording/ros_cdr.h"

#include <array>
#include <vector>

namespace sandrunner {
namespace {

const std::string kRule(80, '=');

/// A definition followed by those of its parts, as `ros2msg` requires.
std::string with_parts(std::string text, const std::vector<std::array<const char*, 2>>& parts) {
  for (const auto& [name, definition] : parts) {
    text += kRule + "\nMSG: " + name + "\n" + definition;
  }
  return text;
}

constexpr const char* kTime = "int32 sec\nuint32 nanosec\n";
constexpr const char* kHeader = "builtin_interfaces/Time stamp\nstring frame_id\n";
constexpr const char* kVector3 = "float64 x\nfloat64 y\nfloat64 z\n";
constexpr const char* kQuaternion = "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n";

void put(CdrWriter& out, const RosHeader& header) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  out.number(static_cast<std::int32_t>(header.stamp_ns / kSecond_ns));
  out.number(static_cast<std::uint32_t>(header.stamp_ns % kSecond_ns));
  out.text(header.frame);
}

void put_quaternion(CdrWriter& out, const std::array<double, 4>& wxyz) {
  out.number(wxyz[1]).number(wxyz[2]).number(wxyz[3]).number(wxyz[0]);
}

/// A TransformStamped; an Odometry begins with the same layout.
void put(CdrWriter& out, const TransformMessage& message) {
  put(out, message.header);
  out.text(message.child_frame).numbers(message.translation);
  put_quaternion(out, message.rotation_wxyz);
}

}  // namespace

RosTopic joint_state_topic() {
  return {"/joint_states", "sensor_msgs/msg/JointState",
          with_parts("std_msgs/Header header\nstring[] name\nfloat64[] position\n"
                     "float64[] velocity\nfloat64[] effort\n",
                     {{"std_msgs/Header", kHeader}, {"builtin_interfaces/Time", kTime}})};
}

RosTopic imu_topic() {
  return {"/imu/data", "sensor_msgs/msg/Imu",
          with_parts("std_msgs/Header header\ngeometry_msgs/Quaternion orientation\n"
                     "float64[9] orientation_covariance\ngeometry_msgs/Vector3 angular_velocity\n"
                     "float64[9] angular_velocity_covariance\n"
                     "geometry_msgs/Vector3 linear_acceleration\n"
                     "float64[9] linear_acceleration_covariance\n",
                     {{"std_msgs/Header", kHeader},
                      {"builtin_interfaces/Time", kTime},
                      {"geometry_msgs/Quaternion", kQuaternion},
                      {"geometry_msgs/Vector3", kVector3}})};
}

RosTopic odometry_topic() {
  return {
      "/odom", "nav_msgs/msg/Odometry",
      with_parts("std_msgs/Header header\nstring child_frame_id\n"
                 "geometry_msgs/PoseWithCovariance pose\n"
                 "geometry_msgs/TwistWithCovariance twist\n",
                 {{"std_msgs/Header", kHeader},
                  {"builtin_interfaces/Time", kTime},
                  {"geometry_msgs/PoseWithCovariance", "Pose pose\nfloat64[36] covariance\n"},
                  {"geometry_msgs/Pose", "Point position\nQuaternion orientation\n"},
                  {"geometry_msgs/Point", kVector3},
                  {"geometry_msgs/Quaternion", kQuaternion},
                  {"geometry_msgs/TwistWithCovariance", "Twist twist\nfloat64[36] covariance\n"},
                  {"geometry_msgs/Twist", "Vector3 linear\nVector3 angular\n"},
                  {"geometry_msgs/Vector3", kVector3}})};
}

RosTopic transforms_topic() {
  return {"/tf", "tf2_msgs/msg/TFMessage",
          with_parts("geometry_msgs/TransformStamped[] transforms\n",
                     {{"geometry_msgs/TransformStamped",
                       "std_msgs/Header header\nstring child_frame_id\nTransform transform\n"},
                      {"std_msgs/Header", kHeader},
                      {"builtin_interfaces/Time", kTime},
                      {"geometry_msgs/Transform", "Vector3 translation\nQuaternion rotation\n"},
                      {"geometry_msgs/Vector3", kVector3},
                      {"geometry_msgs/Quaternion", kQuaternion}})};
}

RosTopic fixed_transforms_topic() {
  RosTopic topic = transforms_topic();
  topic.topic = "/tf_static";
  return topic;
}

RosTopic robot_description_topic() {
  return {"/robot_description", "std_msgs/msg/String", "string data\n"};
}

RosTopic diagnostics_topic() {
  return {"/diagnostics", "diagnostic_msgs/msg/DiagnosticArray",
          with_parts("std_msgs/Header header\nDiagnosticStatus[] status\n",
                     {{"std_msgs/Header", kHeader},
                      {"builtin_interfaces/Time", kTime},
                      {"diagnostic_msgs/DiagnosticStatus",
                       "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\nbyte level\n"
                       "string name\nstring message\nstring hardware_id\nKeyValue[] values\n"},
                      {"diagnostic_msgs/KeyValue", "string key\nstring value\n"}})};
}

CdrWriter cdr(const JointStateMessage& message) {
  CdrWriter out;
  put(out, message.header);
  out.number(std::uint32_t{kNumJoints});
  for (const std::string& name : message.names) out.text(name);
  out.sequence(message.position).sequence(message.velocity).sequence(message.effort);
  return out;
}

CdrWriter cdr(const ImuMessage& message) {
  constexpr std::array<double, 9> kUnknown{};
  CdrWriter out;
  put(out, message.header);
  put_quaternion(out, message.orientation_wxyz);
  out.numbers(kUnknown).numbers(message.angular_velocity).numbers(kUnknown);
  out.numbers(message.linear_acceleration).numbers(kUnknown);
  return out;
}

CdrWriter cdr(const OdometryMessage& message) {
  CdrWriter out;
  put(out, message.pose);
  out.numbers(message.pose_covariance);
  out.numbers(message.linear_velocity).numbers(message.angular_velocity);
  out.numbers(message.twist_covariance);
  return out;
}

CdrWriter cdr(const std::vector<TransformMessage>& transforms) {
  CdrWriter out;
  out.number(static_cast<std::uint32_t>(transforms.size()));
  for (const TransformMessage& transform : transforms) put(out, transform);
  return out;
}

CdrWriter cdr(const DiagnosticsMessage& message) {
  CdrWriter out;
  put(out, message.header);
  out.number(std::uint32_t{1}).number(static_cast<std::uint8_t>(message.level));
  out.text(message.name).text(message.message).text(message.hardware_id);
  out.number(static_cast<std::uint32_t>(message.values.size()));
  for (const auto& [key, value] : message.values) out.text(key).text(value);
  return out;
}

CdrWriter cdr(const std::string& text) {
  CdrWriter out;
  out.text(text);
  return out;
}

}  // namespace sandrunner
