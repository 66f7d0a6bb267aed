// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "estimator/odometry.h"
#include "rt/core/robot_description.h"
#include "rt/core/slower_rate.h"
#include "rt/loop/tick_record.h"
#include "rt/telemetry/diagnostics.h"
#include "rt/telemetry/mcap/mcap_writer.h"

namespace sandrunner {

/// Ticks in a message of a recording, and in a batch that the recorder takes.
inline constexpr std::size_t kTicksPerMessage = 40;

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

/// Turns ticks into an MCAP file: our own records bit for bit, events and, for the usual tools,
/// ROS 2 topics at the rate of the policy, diagnostics once a second. Compresses and writes in the
/// thread that calls it.
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
  void write_event(std::uint64_t tick, const std::string& kind, const std::string& text);
  /// Finishes the file. Throws InputError.
  void close() { file_.close(); }

  std::uint64_t bytes_written() const noexcept { return file_.bytes_written(); }

 private:
  void write_batch(std::span<const TickRecord> ticks);
  void write_events(const TickRecord& tick);
  std::uint64_t time_ns(std::uint64_t tick) const noexcept;

  const std::int64_t start_time_ns_;
  const RobotDescription robot_;
  McapWriter file_;
  struct Channels {
    std::uint16_t ticks = 0, states = 0, events = 0, joint_states = 0, imu = 0, odometry = 0,
                  transforms = 0, diagnostics = 0;
  } channels_;
  Odometry odometry_;
  Diagnostics diagnostics_;
  SlowerRate policy_rate_{kPolicyHz}, diagnostics_rate_{1};
  std::uint64_t bytes_at_state_ = 0;  // of the file, when the last state was written
  std::uint64_t batches_ = 0, states_ = 0, events_ = 0, last_flush_tick_ = 0;
  bool in_the_middle_, has_last_ = false;
  std::uint64_t last_mode_ = 0, last_faults_ = 0, last_warnings_ = 0, last_request_ = 0;
};

inline constexpr const char* kTicksTopic = "/sandrunner/ticks";
inline constexpr const char* kStatesTopic = "/sandrunner/states";
inline constexpr const char* kEventsTopic = "/sandrunner/events";
/// Attachments and metadata of a recording.
inline constexpr const char* kConfigAttachment = "config.toml";
inline constexpr const char* kPolicyAttachment = "policy.safetensors";
inline constexpr const char* kRobotMapAttachment = "robot.toml";
inline constexpr const char* kRobotAttachment = "robot.urdf";
inline constexpr const char* kStateAttachment = "state.bin";
inline constexpr const char* kRunMetadata = "run";

}  // namespace sandrunner
