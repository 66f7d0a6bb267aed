// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rt/telemetry/recording/recording_writer.h"
#include "rt/telemetry/recording/replayed_ticks.h"

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
  std::uint64_t left_out = 0;   ///< faults without a file, beyond kBlackBoxFiles
  std::string stopped_because;  ///< why the black box ended before the run; empty: it did not
  std::size_t peak_bytes = 0;   ///< of the compressed ticks
};

/// Keeps the newest ticks of a run in memory, compressed. Two seconds after a fault, or at the end
/// of the run, it writes them into a recording, DIR/black-box-<tick of the fault>.mcap.
///
/// A recording that begins in the middle needs the state of controller and network before its first
/// tick: each block of ticks has it. A file has these too: damage costs the replay no more than its
/// chunk and the rest of a block. Files behind lost ticks or a difference have no such state.
///
/// A file is written block by block, while ticks come. Measured on a simulated walk: 93 MB of
/// memory, 105 MB with encoder noise; 1.6 % of a core, and 0.7 s of that core per file.
class BlackBox final : public TickKeeper {
 public:
  BlackBox(std::string folder, RecordingInfo info, double window_s = kBlackBox_s);
  ~BlackBox() override;
  BlackBox(const BlackBox&) = delete;
  BlackBox& operator=(const BlackBox&) = delete;

  void begin(std::int64_t start_ns) override { info_.start_time_ns = start_ns; }
  void keep(const TickQueue::Batch& ticks, const std::optional<ReplayState>& before) override;
  /// Writes files that are still due.
  void finish() override;
  /// After finish().
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
  struct File;

  void note_faults(const TickQueue::Batch& batch);
  void close_block();
  void make_files(std::uint64_t ticks_after);
  void write_some();
  template <typename Action>
  void unless_out_of_memory(const Action& action);

  const std::string folder_;
  RecordingInfo info_;  // from the first tick on, only the thread that keeps uses it
  const std::uint64_t kept_ticks_;
  TickQueue::Batch open_ticks_;  // of the next block
  std::string open_state_;       // before them
  std::deque<std::shared_ptr<const Block>> window_;
  std::size_t bytes_ = 0;
  std::deque<Mark> marks_;                   // faults whose files are due
  std::deque<std::unique_ptr<File>> files_;  // not yet written; the first one may be begun
  std::size_t files_made_ = 0;
  std::uint64_t last_faults_ = 0, newest_tick_ = 0;
  BlackBoxResult result_;
};

}  // namespace sandrunner
