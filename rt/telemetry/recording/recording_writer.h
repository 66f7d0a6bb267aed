// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "rt/core/robot_description.h"
#include "rt/loop/tick_record.h"
#include "rt/telemetry/mcap/mcap_writer.h"
#include "rt/telemetry/recording/run_messages.h"

namespace sandrunner {

/// What a recording says about the run besides its ticks; with them, it is enough for a replay.
struct RecordingInfo {
  std::string build;               ///< of the program that ran
  std::string start_mode;          ///< of the controller: "passive" or "walk"
  std::string clock;               ///< "lockstep" or "realtime"
  std::string config;              ///< the settings in effect, TOML
  std::string policy;              ///< the whole policy file; empty: none
  std::string robot_map;           ///< the robot's map (sim/robot/README.md)
  RobotDescription robot;          ///< of a recording that was read, only the URDF
  std::int64_t start_time_ns = 0;  ///< wall clock at tick 0, since 1970
  /// Where the recording begins: at 0, the start of the run, or later. Then it is replayed from
  /// `state`, and cannot be replayed if that is empty.
  std::uint64_t first_tick = 0;
  std::string state;  ///< before `first_tick`: replay_state_bytes() (rt/loop/replay.h)
};

/// The mode in which the controller of the run started.
inline Mode start_mode_of(const RecordingInfo& info) {
  return info.start_mode == "walk" ? Mode::kWalk : Mode::kPassive;
}

/// Turns ticks into an MCAP file: the messages of all topics of a run (run_messages.h), our own
/// records bit for bit. Compresses and writes in the thread that calls it.
class RecordingWriter {
 public:
  /// Throws InputError if the file cannot be written.
  RecordingWriter(const std::string& path, const RecordingInfo& info);

  /// The next ticks, in order. Throws InputError once if the disk is full; what was written until
  /// then is readable. If the process is killed later, at most the last half second is lost.
  void write(std::span<const TickRecord> ticks);
  /// A chunk has ended since the last state was written, or none was: the next chunk can be
  /// replayed by itself only if write_state() comes first.
  bool wants_state() const noexcept { return bytes_written() != bytes_at_state_; }
  /// The state before the next tick (replay_state_bytes()), from which a replay can go on if what
  /// is before it in the file was lost.
  void write_state(std::uint64_t next_tick, const std::string& state);
  /// What an operator did before `tick` to the robot or its ground.
  void write_event(std::uint64_t tick, const std::string& kind, const std::string& text) {
    messages_.add_event(tick, kind, text);
  }
  /// Finishes the file. Throws InputError.
  void close() { file_.close(); }

  std::uint64_t bytes_written() const noexcept { return file_.bytes_written(); }

 private:
  void write_batch(std::span<const TickRecord> ticks);

  McapWriter file_;
  std::array<std::uint16_t, kNumRunTopics> channels_{};  // by RunTopic
  RunMessages messages_;
  std::uint64_t bytes_at_state_ = 0;  // of the file, when the last state was written
  std::uint64_t last_flush_tick_ = 0;
};

/// Attachments and metadata of a recording.
inline constexpr const char* kConfigAttachment = "config.toml";
inline constexpr const char* kPolicyAttachment = "policy.safetensors";
inline constexpr const char* kRobotMapAttachment = "robot.toml";
inline constexpr const char* kRobotAttachment = "robot.urdf";
inline constexpr const char* kStateAttachment = "state.bin";
inline constexpr const char* kRunMetadata = "run";

}  // namespace sandrunner
