// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/recording/recording_file.h"

#include <fmt/format.h>

#include <cstdlib>
#include <cstring>

#include "rt/base/errors.h"
#include "rt/loop/tick_fields.h"
#include "rt/telemetry/mcap/mcap_reader.h"
#include "rt/telemetry/recording/cdr.h"

namespace sandrunner {
namespace {

RecordingInfo info_of(const std::string& path, const McapReader& reader) {
  RecordingInfo info;
  const McapMetadata* run = nullptr;
  for (const McapMetadata& metadata : reader.metadata()) {
    if (metadata.name == kRunMetadata) run = &metadata;
  }
  if (!run)
    throw InputError(fmt::format("{}: found no metadata '{}', expected one of our recordings", path,
                                 kRunMetadata));
  const auto value = [&](const char* key) {
    const auto found = run->values.find(key);
    if (found == run->values.end()) {
      throw InputError(fmt::format("{}: metadata '{}' lacks '{}'", path, kRunMetadata, key));
    }
    return found->second;
  };
  info.build = value("build");
  info.start_mode = value("start_mode");
  info.clock = value("clock");
  info.start_time_ns = std::strtoll(value("start_time_ns").c_str(), nullptr, 10);
  // Recordings from before there were black boxes all begin at tick 0.
  if (const auto first = run->values.find("first_tick"); first != run->values.end()) {
    info.first_tick = std::strtoull(first->second.c_str(), nullptr, 10);
  }
  for (const McapAttachment& attachment : reader.attachments()) {
    if (attachment.name == kConfigAttachment) info.config = attachment.data;
    if (attachment.name == kPolicyAttachment) info.policy = attachment.data;
    if (attachment.name == kRobotAttachment) info.robot.urdf = attachment.data;
    if (attachment.name == kStateAttachment) info.state = attachment.data;
  }
  return info;
}

}  // namespace

RecordingContents read_recording(const std::string& path,
                                 const std::function<void(const RecordingInfo&)>& begin,
                                 const std::function<bool(const TickRecord&)>& tick) {
  McapReader reader(path);
  RecordingContents contents;
  bool begun = false, wanted = true;
  std::uint64_t last_batch = 0;
  const auto start = [&] {
    begun = true;
    contents.info = info_of(path, reader);
    if (begin) begin(contents.info);
  };
  while (const McapMessage* message = reader.next()) {
    const McapChannel& channel = reader.channels().at(message->channel_id);
    const bool is_ticks = channel.topic == kTicksTopic;
    if (is_ticks && reader.schemas().at(channel.schema_id).data != tick_idl()) {
      throw InputError(
          fmt::format("{}: found ticks in the layout of build '{}', expected this build's", path,
                      info_of(path, reader).build));
    }
    if (!begun) start();
    if (!is_ticks) continue;
    CdrReader cdr(message->data);
    const auto batch = cdr.number<std::uint64_t>();
    const auto count = cdr.number<std::uint32_t>();
    const std::span<const std::byte> bytes = cdr.block(count * sizeof(TickRecord), 8);
    if (cdr.failed() || cdr.left() != 0 || batch != last_batch + 1) {
      throw InputError(
          fmt::format("{}: batch {} of ticks is damaged or missing", path, last_batch + 1));
    }
    last_batch = batch;
    for (std::uint32_t i = 0; i < count && wanted; ++i) {
      TickRecord record;
      std::memcpy(&record, bytes.data() + i * sizeof record, sizeof record);
      ++contents.ticks;
      wanted = tick(record);
    }
    if (!wanted) return contents.complete = true, contents;
  }
  if (!begun) start();
  contents.complete = reader.complete();
  return contents;
}

}  // namespace sandrunner
