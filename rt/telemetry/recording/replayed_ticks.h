// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "rt/core/controller.h"
#include "rt/loop/replay.h"
#include "rt/loop/tick_sink.h"
#include "rt/telemetry/recording/tick_queue.h"

namespace sandrunner {

/// Keeps ticks that come through ReplayedTicks: in a file, in memory.
class TickKeeper {
 public:
  virtual ~TickKeeper() = default;
  // TickSink's, in the thread of the ticks:
  virtual void begin(std::int64_t start_ns) = 0;
  virtual void note(std::uint64_t tick, const std::string& kind, const std::string& text) {
    static_cast<void>(tick), static_cast<void>(kind), static_cast<void>(text);
  }
  // In the thread of ReplayedTicks; they throw nothing:
  /// The next ticks, in order. `before`: the state from which a replay can go on with them;
  /// nothing: not known.
  virtual void keep(const TickQueue::Batch& ticks, const std::optional<ReplayState>& before) = 0;
  /// After the last ticks.
  virtual void finish() = 0;
};

/// How the way of the ticks through the queue and the replay went.
struct ReplayedResult {
  std::uint64_t dropped = 0;  ///< ticks that came faster than they could be kept
  /// The first tick that was lost before others; empty: none was. What is behind it is not
  /// verified.
  std::optional<std::uint64_t> lost_from;
  /// The first tick at which the run did not do what follows from its inputs.
  std::optional<ReplayDifference> difference;
};

/// Takes every tick of a run to the keepers, in an ordinary thread of its own, and runs a replay
/// beside the run: it verifies the ticks and yields the state before each batch of them. The queue
/// holds two seconds.
class ReplayedTicks final : public TickSink {
 public:
  /// `policy`: that of the run. `keepers` must outlive this object.
  ReplayedTicks(const ControllerConfig& config, Mode start, PolicyRunner policy, WhenFull when_full,
                std::vector<TickKeeper*> keepers);
  ~ReplayedTicks() override;
  ReplayedTicks(const ReplayedTicks&) = delete;
  ReplayedTicks& operator=(const ReplayedTicks&) = delete;

  void begin(std::int64_t start_ns) override;
  void add(const TickRecord& tick) override { queue_.add(tick); }
  void note(std::uint64_t tick, const std::string& kind, const std::string& text) override;
  /// Waits for the keepers to finish.
  void end() override;
  /// After the end.
  const ReplayedResult& result() const noexcept { return result_; }

 private:
  void work();
  std::optional<ReplayState> state_before(const TickRecord& first);
  void check(const TickQueue::Batch& batch);
  bool in_step() const noexcept { return !result_.difference && !result_.lost_from; }

  TickQueue queue_;
  const std::vector<TickKeeper*> keepers_;
  Replay replay_;  // behind the newest tick, or at the difference or lost ticks
  ReplayedResult result_;
  std::thread thread_;
};

}  // namespace sandrunner
