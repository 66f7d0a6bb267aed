// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/recording/recording_file.h"

#include <fmt/format.h>

#include <charconv>
#include <cstring>
#include <set>
#include <utility>

#include "rt/base/errors.h"
#include "rt/loop/tick_fields.h"
#include "rt/telemetry/mcap/mcap_reader.h"
#include "rt/telemetry/recording/cdr.h"

namespace sandrunner {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw InputError(fmt::format("{}: {}", path, what));
}

const McapMetadata& run_metadata(const std::string& path, const McapReader& reader) {
  for (const McapMetadata& metadata : reader.metadata()) {
    if (metadata.name == kRunMetadata) return metadata;
  }
  fail(path, fmt::format("found no metadata '{}', expected one of our recordings", kRunMetadata));
}

RecordingInfo info_of(const std::string& path, const McapReader& reader) {
  const McapMetadata& run = run_metadata(path, reader);
  const auto text = [&](const char* key) {
    const auto found = run.values.find(key);
    if (found == run.values.end()) {
      fail(path, fmt::format("metadata '{}' lacks '{}'", kRunMetadata, key));
    }
    return found->second;
  };
  const auto one_of = [&](const char* key, const char* a, const char* b) {
    std::string value = text(key);
    if (value != a && value != b) {
      fail(path, fmt::format("metadata '{}': {} is '{}', expected {} or {}", kRunMetadata, key,
                             value, a, b));
    }
    return value;
  };
  const auto number = [&](const char* key, auto& value) {
    const std::string digits = text(key);
    const char* const end = digits.data() + digits.size();
    const auto [stop, error] = std::from_chars(digits.data(), end, value);
    if (error != std::errc() || stop != end) {
      fail(path, fmt::format("metadata '{}': {} is '{}', expected a whole number", kRunMetadata,
                             key, digits));
    }
  };
  RecordingInfo info;
  info.build = text("build");
  info.start_mode = one_of("start_mode", "passive", "walk");
  info.clock = one_of("clock", "lockstep", "realtime");
  number("start_time_ns", info.start_time_ns);
  number("first_tick", info.first_tick);

  std::set<std::string> names;
  for (const McapAttachment& attachment : reader.attachments()) {
    if (!names.insert(attachment.name).second) {
      fail(path, fmt::format("found the attachment '{}' twice", attachment.name));
    }
    if (attachment.name == kConfigAttachment) info.config = attachment.data;
    if (attachment.name == kPolicyAttachment) info.policy = attachment.data;
    if (attachment.name == kRobotMapAttachment) info.robot_map = attachment.data;
    if (attachment.name == kRobotAttachment) info.robot.urdf = attachment.data;
    if (attachment.name == kStateAttachment) info.state = attachment.data;
  }
  return info;
}

// Goes through the messages of a recording and hands on what they hold.
class RecordingReader {
 public:
  RecordingReader(const std::string& path, const RecordingVisitor& visitor)
      : path_(path), visitor_(visitor), reader_(path) {}

  RecordingContents read() {
    while (wanted_) {
      if (const McapMessage* message = next()) {
        take(*message);
      } else if (!lost_ || !reader_.skip_damage()) {
        break;
      }
    }
    if (!begun_) begin();
    contents_.complete = !wanted_ || reader_.complete();
    if (lost_ && wanted_ && visitor_.lost) visitor_.lost(next_tick_, std::nullopt, true);
    return std::move(contents_);
  }

 private:
  /// The next message; null at the end, and at damage, which is noted.
  const McapMessage* next() {
    try {
      const McapMessage* message = reader_.next();
      // A cut file has no chunk behind its end; one in which a length is wrong has.
      while (!message && begun_ && !reader_.complete() && reader_.skip_damage()) {
        note_damage(fmt::format("{}: found a record that is longer than the file", path_));
        message = reader_.next();
      }
      return message;
    } catch (const InputError& error) {
      if (!begun_) throw;
      note_damage(error.what());
      return nullptr;
    }
  }

  void note_damage(const std::string& what) {
    if (contents_.damage.empty()) contents_.damage = what;
    lost_ = true;
  }

  void begin() {
    contents_.info = info_of(path_, reader_);
    begun_ = true;
    next_tick_ = contents_.info.first_tick;
    if (visitor_.begin) visitor_.begin(contents_.info);
  }

  void take(const McapMessage& message) {
    const McapChannel& channel = reader_.channels().at(message.channel_id);
    const bool is_ticks = channel.topic == kTicksTopic;
    if (is_ticks) check_layout(channel);
    if (!begun_) begin();
    CdrReader cdr(message.data);
    if (is_ticks) take_ticks(cdr);
    if (channel.topic == kStatesTopic && visitor_.state) take_state(cdr);
    if (channel.topic == kEventsTopic && visitor_.event) take_event(cdr);
  }

  void check_layout(const McapChannel& channel) const {
    const auto schema = reader_.schemas().find(channel.schema_id);
    if (schema == reader_.schemas().end()) {
      fail(path_, fmt::format("the channel of {} has no schema", kTicksTopic));
    }
    if (schema->second.data == tick_idl()) return;
    fail(path_, fmt::format("found ticks in the layout of build '{}', expected this build's",
                            info_of(path_, reader_).build));
  }

  void take_ticks(CdrReader& cdr) {
    const auto batch = cdr.number<std::uint64_t>();
    const auto count = cdr.number<std::uint32_t>();
    const std::span<const std::byte> bytes = cdr.block(count * sizeof(TickRecord), 8);
    if (cdr.failed() || cdr.left() != 0 || batch <= last_batch_) {
      fail(path_, fmt::format("batch {} of ticks is damaged", last_batch_ + 1));
    }
    if (batch != last_batch_ + 1 && !lost_) {
      note_damage(fmt::format("{}: batch {} of ticks is missing", path_, last_batch_ + 1));
    }
    last_batch_ = batch;
    for (std::uint32_t i = 0; i < count && wanted_; ++i) {
      TickRecord record;
      std::memcpy(&record, bytes.data() + i * sizeof record, sizeof record);
      check_place(record);
      if (state_ && visitor_.state) visitor_.state(*state_);
      state_.reset();
      next_tick_ = record.input.sensors.tick + 1;
      ++contents_.ticks;
      wanted_ = !visitor_.tick || visitor_.tick(record);
    }
  }

  /// Reports the ticks that are missing before this one.
  void check_place(const TickRecord& record) {
    const std::uint64_t tick = record.input.sensors.tick;
    const bool by_damage = std::exchange(lost_, false);  // not every damage costs ticks
    if (by_damage) {
      if (tick > next_tick_ && visitor_.lost) visitor_.lost(next_tick_, tick - 1, true);
      return;
    }
    const std::uint64_t missing = missing_before(record, next_tick_);
    // A loop that was held up may skip slots before its first tick.
    if (contents_.ticks == 0 && tick != next_tick_ && tick != next_tick_ + record.skipped) {
      fail(path_, fmt::format("metadata '{}': first_tick is {}, but the first tick is {}",
                              kRunMetadata, next_tick_, tick));
    }
    if (missing == 0) return;
    contents_.lost += missing;
    if (visitor_.lost) visitor_.lost(next_tick_, next_tick_ + missing - 1, false);
  }

  void take_state(CdrReader& cdr) {
    const std::span<const std::byte> bytes = cdr.block(cdr.number<std::uint32_t>(), 1);
    state_.emplace(read_replay_state({reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                                     fmt::format("{}: a state behind tick {}", path_, next_tick_)));
  }

  void take_event(CdrReader& cdr) const {
    const auto tick = cdr.number<std::uint64_t>();
    const std::string kind = cdr.text(), text = cdr.text();
    if (cdr.failed()) fail(path_, fmt::format("an event behind tick {} is damaged", next_tick_));
    visitor_.event(tick, kind, text);
  }

  const std::string& path_;
  const RecordingVisitor& visitor_;
  McapReader reader_;
  RecordingContents contents_;
  bool begun_ = false, wanted_ = true;
  bool lost_ = false;                 ///< damage since the last tick
  std::optional<ReplayState> state_;  ///< before the next tick; told behind what was lost
  std::uint64_t last_batch_ = 0, next_tick_ = 0;
};

}  // namespace

RecordingContents read_recording(const std::string& path, const RecordingVisitor& visitor) {
  return RecordingReader(path, visitor).read();
}

}  // namespace sandrunner
