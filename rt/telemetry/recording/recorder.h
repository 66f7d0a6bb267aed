// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "rt/core/controller.h"
#include "rt/loop/replay.h"
#include "rt/loop/tick_sink.h"
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
  std::uint64_t dropped = 0;  ///< ticks that came faster than they could be written
  std::uint64_t bytes = 0;
  std::string stopped_because;  ///< a limit or a full disk; empty: the recording is complete
  bool failed = false;          ///< it was the disk or a lack of memory, not a limit
  bool removed = false;         ///< somebody removed or renamed the file during the run
};

/// Writes every tick of a run into a file (recording_writer.h) in a thread of its own.
///
/// Given the controller's settings, it runs a replay beside the run, and each chunk of the file
/// begins with the state from which it can be replayed: a damaged chunk costs no other.
///
/// A disk that fills up, a limit or a lack of memory ends the recording, not the run. A process
/// that is killed loses at most the last second. The file is created with the first tick: a run
/// that is refused leaves the previous recording untouched.
class Recorder final : public TickSink {
 public:
  /// `wait`: while the queue is full, add() waits (in lockstep, where that hurts nobody) instead of
  /// dropping and counting the newest ticks. `policy`: that of the run. Throws
  /// InputError if the file cannot be written.
  Recorder(const std::string& path, RecordingInfo info, const RecordingLimits& limits, bool wait,
           const ControllerConfig* config = nullptr, PolicyRunner policy = {});
  ~Recorder() override;
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  void begin(std::int64_t start_ns) override { info_.start_time_ns = start_ns; }
  void add(const TickRecord& tick) override { queue_.add(tick); }
  void note(std::uint64_t tick, const std::string& kind, const std::string& text) override;
  /// Finishes the file.
  void end() override;
  /// After the end.
  const RecordingResult& result() const noexcept { return result_; }

 private:
  void work();
  void write(const TickQueue::Batch& batch);
  void write_notes();
  void write_state();
  void stop(const std::string& reason, bool failed);

  const std::string path_;
  const RecordingLimits limits_;
  RecordingInfo info_;  // from the first tick on, only the thread that writes uses it
  TickQueue queue_;
  struct Note {
    std::uint64_t tick;
    std::string kind, text;
  };
  std::mutex notes_mutex_;
  std::vector<Note> notes_;  // that are not written yet
  // Only the thread that writes uses what follows.
  std::optional<Replay> replay_;  // before the next tick; nothing once ticks are missing
  std::optional<RecordingWriter> writer_;
  std::uint64_t bytes_at_state_ = 0;  // of the file, when the last state was written
  bool stopped_ = false;
  RecordingResult result_;
  std::thread thread_;
};

}  // namespace sandrunner
