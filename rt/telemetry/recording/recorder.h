// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <thread>

#include "rt/telemetry/recording/recording_writer.h"
#include "rt/telemetry/recording/tick_queue.h"

namespace sandrunner {

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

/// Writes every tick of a run into a file (recording_writer.h) in a thread of its own.
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
  void add(const TickRecord& tick) { queue_.add(tick); }
  /// Finishes the file. Nothing may be added afterwards.
  RecordingResult close();

 private:
  void work();
  void write(const TickQueue::Batch& batch);
  void stop(const std::string& reason);

  const RecordingLimits limits_;
  RecordingWriter writer_;
  TickQueue queue_;
  // Of the thread that writes.
  bool stopped_ = false;
  RecordingResult result_;
  std::thread thread_;
};

}  // namespace sandrunner
