// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/recording/recording_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

namespace sandrunner {
namespace {

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

}  // namespace

RecordingWriter::RecordingWriter(const std::string& path, const RecordingInfo& info)
    : file_(path),
      messages_(info.robot, info.start_time_ns, info.first_tick,
                [this](const RunMessages::Message& message) {
                  file_.write_message({
                      .channel_id = channels_[index_of(message.topic)],
                      .sequence = static_cast<std::uint32_t>(message.sequence),
                      .log_time_ns = message.time_ns,
                      .publish_time_ns = message.time_ns,
                      .data = message.content.bytes(),
                  });
                }) {
  file_.write_metadata({kRunMetadata,
                        {{"build", info.build},
                         {"start_mode", info.start_mode},
                         {"clock", info.clock},
                         {"start_time_ns", fmt::format("{}", info.start_time_ns)},
                         {"first_tick", fmt::format("{}", info.first_tick)}}});
  const auto attach = [&](const char* name, const char* type, const std::string& data) {
    if (data.empty()) return;
    file_.write_attachment({.log_time_ns = messages_.time_ns(info.first_tick),
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
  for (std::size_t i = 0; i < kNumRunTopics; ++i) {
    const RunTopicInfo& topic = run_topics()[i];
    channels_[i] = file_.add_channel(
        file_.add_schema(topic.schema, topic.schema_encoding, topic.schema_text), topic.name, "cdr",
        {{"offered_qos_profiles", topic.once ? kLatched : ""}});
  }
  messages_.begin();
}

void RecordingWriter::write(std::span<const TickRecord> ticks) {
  while (!ticks.empty()) {
    const std::size_t count = std::min(ticks.size(), kTicksPerMessage);
    write_batch(ticks.first(count));
    ticks = ticks.subspan(count);
  }
}

void RecordingWriter::write_state(std::uint64_t next_tick, const std::string& state) {
  messages_.add_state(next_tick, state);
  bytes_at_state_ = bytes_written();
}

void RecordingWriter::write_batch(std::span<const TickRecord> batch) {
  messages_.add_batch(batch);
  for (const TickRecord& tick : batch) messages_.add(tick);
  const std::uint64_t first = batch.front().input.sensors.tick;
  if (first - last_flush_tick_ >= kControlHz / 2) {
    file_.flush();
    last_flush_tick_ = first;
  }
}

}  // namespace sandrunner
