// SPDX-License-Identifier: BSD-3-Clause
#include "tools/ctl/message_text.h"

#include <fmt/format.h>

#include <algorithm>

#include "rt/base/errors.h"
#include "rt/base/fixed_text.h"
#include "rt/core/mode_machine.h"
#include "rt/telemetry/diagnostics.h"

namespace sandrunner::ctl {
namespace {

std::string clean(const char* text) { return one_line(text ? text : ""); }

std::string stamp(const builtin_interfaces_msg_dds__Time_& t) {
  return fmt::format("{}.{:09}", t.sec, t.nanosec);
}

template <typename V>  // Vector3_ and Point_
std::string xyz(const V& v) {
  return fmt::format("{} {} {}", fixed_text(v.x, 3), fixed_text(v.y, 3), fixed_text(v.z, 3));
}

std::string wxyz(const geometry_msgs_msg_dds__Quaternion_& q) {
  return fmt::format("{} {} {} {}", fixed_text(q.w, 4), fixed_text(q.x, 4), fixed_text(q.y, 4),
                     fixed_text(q.z, 4));
}

}  // namespace

const char* mode_text(std::uint32_t mode) {
  return mode <= static_cast<std::uint32_t>(Mode::kFault) ? mode_name(static_cast<Mode>(mode))
                                                          : "unknown";
}

std::string text(const sensor_msgs_msg_dds__JointState_& m) {
  std::string out = stamp(m.header.stamp) + "  rad, rad/s, Nm:";
  const auto value = [](const dds_sequence_double& values, std::uint32_t i) {
    return i < values._length ? values._buffer[i] : 0.0;
  };
  for (std::uint32_t i = 0; i < m.name._length; ++i) {
    out +=
        fmt::format("  {} {} {} {}", clean(m.name._buffer[i]), fixed_text(value(m.position, i), 3),
                    fixed_text(value(m.velocity, i), 2), fixed_text(value(m.effort, i), 2));
  }
  return out;
}

std::string text(const sensor_msgs_msg_dds__Imu_& m) {
  return fmt::format("{}  orientation wxyz {}  turning {} rad/s  acceleration {} m/s2",
                     stamp(m.header.stamp), wxyz(m.orientation), xyz(m.angular_velocity),
                     xyz(m.linear_acceleration));
}

std::string text(const nav_msgs_msg_dds__Odometry_& m) {
  return fmt::format(
      "{}  position {} m  orientation wxyz {}  velocity {} m/s  turning {} rad/s  variance of x "
      "{:.4f} m2",
      stamp(m.header.stamp), xyz(m.pose.pose.position), wxyz(m.pose.pose.orientation),
      xyz(m.twist.twist.linear), xyz(m.twist.twist.angular), m.pose.covariance[0]);
}

std::string text(const tf2_msgs_msg_dds__TFMessage_& m) {
  std::string out;
  for (std::uint32_t i = 0; i < m.transforms._length; ++i) {
    const auto& t = m.transforms._buffer[i];
    out += fmt::format("{}{}  {} to {}: {} m, wxyz {}", i == 0 ? "" : "  ", stamp(t.header.stamp),
                       clean(t.header.frame_id), clean(t.child_frame_id),
                       xyz(t.transform.translation), wxyz(t.transform.rotation));
  }
  return out;
}

std::string text(const std_msgs_msg_dds__String_& m) { return clean(m.data); }

std::string text(const diagnostic_msgs_msg_dds__DiagnosticArray_& m) {
  constexpr const char* kLevels[] = {"ok", "warning", "error", "stale"};
  std::string out = stamp(m.header.stamp);
  for (std::uint32_t i = 0; i < m.status._length; ++i) {
    const auto& s = m.status._buffer[i];
    out += fmt::format("  {} {}: {};", clean(s.name), s.level < 4 ? kLevels[s.level] : "unknown",
                       clean(s.message));
    for (std::uint32_t k = 0; k < s.values._length; ++k) {
      out +=
          fmt::format(" {}={};", clean(s.values._buffer[k].key), clean(s.values._buffer[k].value));
    }
  }
  return out;
}

std::string text(const geometry_msgs_msg_dds__Twist_& m) {
  return fmt::format("linear {} m/s  angular {} rad/s", xyz(m.linear), xyz(m.angular));
}

std::string text(const geometry_msgs_msg_dds__TwistStamped_& m) {
  return stamp(m.header.stamp) + "  " + text(m.twist);
}

std::string text(const sandrunner_TickBatch& m) {
  std::string out = fmt::format("#{}  {}.{:09}", m.sequence_number, m.stamp_ns / 1'000'000'000,
                                m.stamp_ns % 1'000'000'000);
  if (m.ticks._length == 0) return out + "  no ticks";
  std::uint32_t late_ns = 0, control_ns = 0, write_ns = 0;
  std::uint64_t skipped = 0;
  for (std::uint32_t i = 0; i < m.ticks._length; ++i) {
    const sandrunner_TickState& t = m.ticks._buffer[i];
    late_ns = std::max(late_ns, t.late_ns);
    control_ns = std::max(control_ns, t.control_ns);
    write_ns = std::max(write_ns, t.write_ns);
    skipped += t.skipped;
  }
  const sandrunner_TickState& last = m.ticks._buffer[m.ticks._length - 1];
  const auto us = [](std::uint32_t ns) { return 1e-3 * ns; };
  return out + fmt::format(
                   "  ticks {} to {}  mode {}  faults {}  command {:.2f} {:.2f} {:.2f}  velocity "
                   "{:.2f} {:.2f} {:.2f}  height {:.3f}  skipped {}  at most us: late {:.1f} "
                   "control {:.1f} write {:.1f}",
                   m.ticks._buffer[0].tick, last.tick, mode_text(last.mode),
                   fault_names(last.faults), last.command[0], last.command[1], last.command[2],
                   last.body_velocity_mps[0], last.body_velocity_mps[1], last.body_velocity_mps[2],
                   last.body_height_m, skipped, us(late_ns), us(control_ns), us(write_ns));
}

std::string text(const sandrunner_ModeRequest& m) {
  return fmt::format("{:016x}  {}", m.id, clean(m.request));
}

std::string text(const sandrunner_ModeReply& m) {
  return fmt::format("{:016x}  {}  mode {}  robot {}", m.id,
                     m.accepted ? "accepted" : "refused: " + clean(m.reason), clean(m.mode),
                     clean(m.robot));
}

}  // namespace sandrunner::ctl
