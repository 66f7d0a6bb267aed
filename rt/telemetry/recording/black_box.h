// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
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

/// What is kept from before a fault.
inline constexpr double kBlackBox_s = 30.0;
/// What a file holds from after the fault: how the robot is let down.
inline constexpr double kBlackBoxAfter_s = 2.0;
inline constexpr std::size_t kBlackBoxFiles = 10;  ///< per run, at most

/// One fault and its file.
struct BlackBoxFile {
  Fault fault = Fault::kNone;
  std::uint64_t fault_tick = 0;
  double before_s = 0.0;  ///< how much the file holds from before the fault
  std::string path;
  bool has_start = true;  ///< it can be replayed: the state before its first tick is known
  std::string problem;    ///< why the file could not be written; empty: it was
};

struct BlackBoxResult {
  std::vector<BlackBoxFile> files;
  std::uint64_t left_out = 0;  ///< faults without a file, beyond kBlackBoxFiles
  std::uint64_t dropped = 0;   ///< ticks that came faster than they could be compressed
  /// The first tick that was lost before others; empty: none was. What is behind it is not
  /// verified, and files that begin later have no start.
  std::optional<std::uint64_t> lost_from;
  /// The first tick at which the run did not do what follows from its inputs. Files that begin
  /// later have no start.
  std::optional<ReplayDifference> difference;
  std::string stopped_because;  ///< why the black box ended before the run; empty: it did not
  std::size_t peak_bytes = 0;   ///< of the compressed ticks
};

/// Keeps the newest ticks of a run in memory, compressed, and writes them into a recording
/// (DIR/black-box-<tick of the fault>.mcap) two seconds after a fault or at the end of the run.
///
/// A recording that begins in the middle needs the state of controller and network before its first
/// tick. That is why a replay runs along: it verifies the ticks and yields the state before each
/// block of them. A file has these too: damage costs the replay no more than its chunk and the rest
/// of a block.
///
/// All this happens in an ordinary thread of its own. Measured on a simulated walk: 93 MB of
/// memory, 105 MB with encoder noise; 1.6 % of a core, and 0.7 s of that core per file.
class BlackBox final : public TickSink {
 public:
  /// `policy`: that of the run. `wait`: as for Recorder.
  BlackBox(std::string folder, RecordingInfo info, const ControllerConfig& config,
           PolicyRunner policy, double window_s = kBlackBox_s, bool wait = false);
  ~BlackBox() override;
  BlackBox(const BlackBox&) = delete;
  BlackBox& operator=(const BlackBox&) = delete;

  void begin(std::int64_t start_ns) override { info_.start_time_ns = start_ns; }
  /// If the queue, which holds two seconds, is full, the newest ticks are dropped and counted.
  void add(const TickRecord& tick) override { queue_.add(tick); }
  /// Writes files that are still due.
  void end() override;
  /// After the end.
  const BlackBoxResult& result() const noexcept { return result_; }

 private:
  /// Consecutive ticks, compressed.
  struct Block {
    std::uint64_t first_tick = 0, last_tick = 0;
    std::size_t ticks = 0;
    std::vector<std::byte> bytes;
    std::string state;  // before its first tick: replay_state_bytes(); empty: not known
  };
  struct Mark {
    Fault fault = Fault::kNone;
    std::uint64_t tick = 0;
  };

  void work();
  void keep(const TickQueue::Batch& batch);
  void note_faults(const TickQueue::Batch& batch);
  std::string replay(const TickQueue::Batch& batch);
  void write_marked(std::uint64_t ticks_after);
  void write(const Mark& mark);
  void keep_queued();
  void write_recording(const std::string& path, const RecordingInfo& info);

  const std::string folder_;
  RecordingInfo info_;  // from the first tick on, only its thread uses it
  const std::uint64_t kept_ticks_;
  TickQueue queue_;
  // Only its thread uses what follows.
  Replay replay_;  // behind the newest tick, or at the difference or lost ticks
  std::deque<std::shared_ptr<const Block>> window_;
  std::size_t bytes_ = 0;
  std::deque<Mark> marks_;  // faults whose files are due
  std::uint64_t last_faults_ = 0, newest_tick_ = 0;
  BlackBoxResult result_;
  std::thread thread_;
};

}  // namespace sandrunner
