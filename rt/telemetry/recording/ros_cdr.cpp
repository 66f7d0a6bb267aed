// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/recording/ros_cdr.h"

#include <array>
#include <vector>

namespace sandrunner {
namespace {

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
