// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "rt/telemetry/odometry.h"
#include "rt/telemetry/mcap/mcap_writer.h"
#include "rt/tick_record.h"

namespace sandrunner {

/// What a recording says about the run, besides its ticks: enough to replay it.
struct RecordingInfo {
  std::string build;               ///< of the program that made the ticks
  std::string start_mode;          ///< of the controller: "passive" or "walk"
  std::string clock;               ///< "lockstep" or "realtime"
  std::string config;              ///< effective settings, TOML
  std::string policy;              ///< the policy file, whole; empty: none
  std::string robot;               ///< robot description, URDF
  std::int64_t start_time_ns = 0;  ///< of tick 0, since 1970
};

struct RecordingLimits {
  std::uint64_t bytes = std::uint64_t{64} << 30;
  double time_s = 24.0 * 3600.0;
};

/// How a recording went.
struct RecordingResult {
  std::uint64_t ticks = 0;    ///< in the file
  std::uint64_t dropped = 0;  ///< that came faster than they could be written
  std::uint64_t bytes = 0;
  std::string stopped_because;  ///< of a limit or a full disk; empty: it is complete
};

/// Writes every tick of a run into an MCAP file: our own records bit for bit, and ROS 2 topics at
/// the rate of the policy for the usual tools. A thread of its own compresses and writes.
///
/// A disk that fills up or a limit ends the recording, not the run. A kill loses at most the last
/// second.
class Recorder {
 public:
  /// `wait`: add() waits for a full queue (lockstep, where nothing else suffers) instead of
  /// dropping the newest ticks and counting them. Throws InputError if the file cannot be written.
  Recorder(const std::string& path, const RecordingInfo& info, const RecordingLimits& limits,
           bool wait);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Every tick, in order, from one ordinary thread.
  void add(const TickRecord& tick);
  /// Finishes the file. Nothing may be added afterwards.
  RecordingResult close();

 private:
  using Batch = std::vector<TickRecord>;
  void hand_over();
  void work();
  void write(const Batch& batch);
  void write_events(const TickRecord& tick);
  void stop(const std::string& reason);
  std::uint64_t time_ns(std::uint64_t tick) const noexcept;

  const std::int64_t start_time_ns_;
  const RecordingLimits limits_;
  const bool wait_;
  McapWriter writer_;
  struct Channels {
    std::uint16_t ticks = 0, events = 0, joint_states = 0, imu = 0, odometry = 0, transforms = 0;
  } channels_;

  // Of the thread that adds.
  Batch batch_;
  // Between the threads.
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Batch> queue_;
  bool closing_ = false;
  std::uint64_t dropped_ = 0;
  // Of the thread that writes.
  Odometry odometry_;
  std::uint64_t batches_ = 0, events_ = 0, last_flush_tick_ = 0;
  bool has_last_ = false;
  std::uint64_t last_mode_ = 0, last_faults_ = 0, last_request_ = 0;
  bool stopped_ = false;
  RecordingResult result_;
  std::thread thread_;
};

inline constexpr const char* kTicksTopic = "/sandrunner/ticks";
inline constexpr const char* kEventsTopic = "/sandrunner/events";
/// Attachments and metadata of a recording.
inline constexpr const char* kConfigAttachment = "config.toml";
inline constexpr const char* kPolicyAttachment = "policy.safetensors";
inline constexpr const char* kRobotAttachment = "robot.urdf";
inline constexpr const char* kRunMetadata = "run";

}  // namespace sandrunner
