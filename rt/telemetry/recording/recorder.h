// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "rt/telemetry/recording/recording_writer.h"
#include "rt/telemetry/recording/replayed_ticks.h"

namespace sandrunner {

struct RecordingLimits {
  std::uint64_t bytes = std::uint64_t{64} << 30;
  double time_s = 24.0 * 3600.0;
};

/// How a recording went.
struct RecordingResult {
  std::uint64_t ticks = 0;  ///< in the file
  std::uint64_t bytes = 0;
  std::string stopped_because;  ///< a limit or a full disk; empty: the recording is complete
  bool failed = false;          ///< it was the disk or a lack of memory, not a limit
  bool removed = false;         ///< the file was removed or renamed during the run
};

/// Writes every tick of a run into a file (recording_writer.h). Each chunk of the file begins with
/// the state from which it can be replayed: a damaged chunk costs no other.
///
/// A disk that fills up, a limit or a lack of memory ends the recording, not the run. A process
/// that is killed loses at most the last second. The file is created with the first tick: a run
/// that is refused leaves the previous recording untouched.
class Recorder final : public TickKeeper {
 public:
  /// Throws InputError if the file cannot be written.
  Recorder(const std::string& path, RecordingInfo info, const RecordingLimits& limits);

  void begin(std::int64_t start_ns) override { info_.start_time_ns = start_ns; }
  void note(std::uint64_t tick, const std::string& kind, const std::string& text) override;
  void keep(const TickQueue::Batch& ticks, const std::optional<ReplayState>& before) override;
  void finish() override;
  /// After finish().
  const RecordingResult& result() const noexcept { return result_; }

 private:
  void write(const TickQueue::Batch& batch, const std::optional<ReplayState>& before);
  void write_notes();
  void stop(const std::string& reason, bool failed);

  const std::string path_;
  const RecordingLimits limits_;
  RecordingInfo info_;  // from the first tick on, only the thread that writes uses it
  struct Note {
    std::uint64_t tick;
    std::string kind, text;
  };
  std::mutex notes_mutex_;
  std::vector<Note> notes_;  // that are not written yet
  // Only the thread that writes uses what follows.
  std::optional<RecordingWriter> writer_;
  bool stopped_ = false;
  RecordingResult result_;
};

}  // namespace sandrunner
