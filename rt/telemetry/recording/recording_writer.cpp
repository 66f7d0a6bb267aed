// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/recording/recording_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "rt/core/mode_machine.h"
#include "rt/loop/tick_fields.h"
#include "rt/telemetry/recording/ros_cdr.h"

namespace sandrunner {
namespace {

constexpr const char* kStateIdl =
    "module sandrunner {\n  struct ReplayState {\n    sequence<octet> bytes;\n  };\n};\n";
constexpr const char* kEventIdl =
    "module sandrunner {\n  struct Event {\n    unsigned long long tick;\n    string kind;\n"
    "    string text;\n  };\n};\n";

// The QoS with which `ros2 bag play` offers a topic, as rosbag2 writes it: a list of one profile,
// values of the enumerations as numbers, which every release from Humble on reads (later ones write
// names). 1, 1, 1: keep last, reliable, transient local. Empty: rosbag2's default, which is
// volatile: a subscriber that comes late, or asks for transient local as RViz and tf2 do, gets
// nothing.
constexpr const char* kLatched =
    "- history: 1\n  depth: 1\n  reliability: 1\n  durability: 1\n"
    "  deadline:\n    sec: 9223372036\n    nsec: 854775807\n"
    "  lifespan:\n    sec: 9223372036\n    nsec: 854775807\n"
    "  liveliness: 1\n"
    "  liveliness_lease_duration:\n    sec: 9223372036\n    nsec: 854775807\n"
    "  avoid_ros_namespace_conventions: false";

McapMap qos(const char* profiles = "") { return {{"offered_qos_profiles", profiles}}; }

}  // namespace

RecordingWriter::RecordingWriter(const std::string& path, const RecordingInfo& info)
    : start_time_ns_(info.start_time_ns),
      robot_(info.robot),
      file_(path),
      odometry_(info.robot),
      diagnostics_(info.robot),
      in_the_middle_(info.first_tick > 0) {
  file_.write_metadata({kRunMetadata,
                        {{"build", info.build},
                         {"start_mode", info.start_mode},
                         {"clock", info.clock},
                         {"start_time_ns", fmt::format("{}", info.start_time_ns)},
                         {"first_tick", fmt::format("{}", info.first_tick)}}});
  const auto attach = [&](const char* name, const char* type, const std::string& data) {
    if (data.empty()) return;
    file_.write_attachment({.log_time_ns = time_ns(info.first_tick),
                            .create_time_ns = 0,
                            .name = name,
                            .media_type = type,
                            .data = data});
  };
  attach(kConfigAttachment, "application/toml", info.config);
  attach(kPolicyAttachment, "application/octet-stream", info.policy);
  attach(kRobotMapAttachment, "application/toml", info.robot_map);
  attach(kRobotAttachment, "application/xml", info.robot.urdf);
  attach(kStateAttachment, "application/octet-stream", info.state);
  const auto own = [&](const char* topic, const char* name, const std::string& idl) {
    return file_.add_channel(file_.add_schema(name, "omgidl", idl), topic, "cdr", qos());
  };
  channels_.ticks = own(kTicksTopic, "sandrunner::TickRecordBatch", tick_idl());
  channels_.states = own(kStatesTopic, "sandrunner::ReplayState", kStateIdl);
  channels_.events = own(kEventsTopic, "sandrunner::Event", kEventIdl);
  const auto ros = [&](const RosTopic& topic, const char* profiles = "") {
    return file_.add_channel(file_.add_schema(topic.schema, "ros2msg", topic.text), topic.topic,
                             "cdr", qos(profiles));
  };
  channels_.joint_states = ros(joint_state_topic());
  channels_.imu = ros(imu_topic());
  channels_.odometry = ros(odometry_topic());
  channels_.transforms = ros(transforms_topic());
  channels_.diagnostics = ros(diagnostics_topic());
  // What ROS 2 gives to readers that come later; here it comes first.
  const std::uint64_t begin_ns = time_ns(info.first_tick);
  const auto once = [&](const RosTopic& topic, const CdrWriter& content) {
    file_.write_message({.channel_id = ros(topic, kLatched),
                         .sequence = 1,
                         .log_time_ns = begin_ns,
                         .publish_time_ns = begin_ns,
                         .data = content.bytes()});
  };
  once(robot_description_topic(), cdr(robot_.ros_urdf));
  once(fixed_transforms_topic(),
       cdr(fixed_transforms(robot_, static_cast<std::int64_t>(begin_ns))));
}

void RecordingWriter::write(std::span<const TickRecord> ticks) {
  while (!ticks.empty()) {
    const std::size_t count = std::min(ticks.size(), kTicksPerMessage);
    write_batch(ticks.first(count));
    ticks = ticks.subspan(count);
  }
}

void RecordingWriter::write_state(std::uint64_t next_tick, const std::string& state) {
  CdrWriter cdr;
  cdr.number(static_cast<std::uint32_t>(state.size()));
  cdr.block(std::as_bytes(std::span(state)), 1);
  file_.write_message({.channel_id = channels_.states,
                       .sequence = static_cast<std::uint32_t>(++states_),
                       .log_time_ns = time_ns(next_tick),
                       .publish_time_ns = time_ns(next_tick),
                       .data = cdr.bytes()});
  bytes_at_state_ = bytes_written();
}

void RecordingWriter::write_batch(std::span<const TickRecord> batch) {
  const std::uint64_t first = batch.front().input.sensors.tick;
  const auto message = [&](std::uint16_t channel, std::uint64_t sequence, std::uint64_t tick,
                           const CdrWriter& content) {
    file_.write_message({.channel_id = channel,
                         .sequence = static_cast<std::uint32_t>(sequence),
                         .log_time_ns = time_ns(tick),
                         .publish_time_ns = time_ns(tick),
                         .data = content.bytes()});
  };
  CdrWriter ticks;
  ticks.number(++batches_).number(static_cast<std::uint32_t>(batch.size()));
  ticks.block(std::as_bytes(batch), 8);
  message(channels_.ticks, batches_, first, ticks);

  for (const TickRecord& tick : batch) {
    odometry_.add(tick.input, tick.output);
    diagnostics_.add(tick);
    write_events(tick);
    const std::uint64_t number = tick.input.sensors.tick;
    if (!policy_rate_.due(number)) continue;
    const auto now = static_cast<std::int64_t>(time_ns(number));
    const std::uint64_t sequence = number / kTicksPerPolicyStep;
    message(channels_.joint_states, sequence, number, cdr(joint_state_message(tick, robot_, now)));
    message(channels_.imu, sequence, number, cdr(imu_message(tick, robot_, now)));
    message(channels_.odometry, sequence, number, cdr(odometry_message(odometry_, robot_, now)));
    message(channels_.transforms, sequence, number,
            cdr(moving_transforms(tick, odometry_, robot_, now)));
    if (!diagnostics_rate_.due(number)) continue;
    message(channels_.diagnostics, number / kControlHz, number, cdr(diagnostics_.message(now)));
  }
  if (first - last_flush_tick_ >= kControlHz / 2) {
    file_.flush();
    last_flush_tick_ = first;
  }
}

void RecordingWriter::write_event(std::uint64_t tick, const std::string& kind,
                                  const std::string& text) {
  CdrWriter cdr;
  cdr.number(tick).text(kind).text(text);
  file_.write_message({.channel_id = channels_.events,
                       .sequence = static_cast<std::uint32_t>(++events_),
                       .log_time_ns = time_ns(tick),
                       .publish_time_ns = time_ns(tick),
                       .data = cdr.bytes()});
}

void RecordingWriter::write_events(const TickRecord& tick) {
  const auto event = [&](const char* kind, const std::string& text) {
    write_event(tick.input.sensors.tick, kind, text);
  };
  const auto mode = static_cast<std::uint64_t>(tick.output.mode);
  const std::uint64_t request = tick.input.command.request_id;
  if (!has_last_ && in_the_middle_) last_request_ = request;
  if (!has_last_ || mode != last_mode_) event("mode", mode_name(tick.output.mode));
  if (request != last_request_) {
    const RequestRow* const row = row_of(tick.input.command.request);
    event("request", row ? row->name : "none");
  }
  for (int bit = 0; bit < kNumFaults; ++bit) {
    const std::uint64_t mask = std::uint64_t{1} << bit;
    if ((tick.output.faults & mask) != 0 && (last_faults_ & mask) == 0) {
      event("fault", fault_name(static_cast<Fault>(mask)));
    }
  }
  if (tick.output.warnings != 0 && last_warnings_ == 0) {
    event("warning", warning_name(tick.output.warnings));
  }
  if (tick.skipped > 0) event("skipped", fmt::format("{} ticks", tick.skipped));
  has_last_ = true;
  last_mode_ = mode;
  last_faults_ = tick.output.faults;
  last_warnings_ = tick.output.warnings;
  last_request_ = request;
}

std::uint64_t RecordingWriter::time_ns(std::uint64_t tick) const noexcept {
  return static_cast<std::uint64_t>(start_time_ns_) + tick * kControlPeriod_ns;
}

}  // namespace sandrunner
