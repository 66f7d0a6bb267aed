// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>

#include "rt/core/controller.h"
#include "rt/core/log_histogram.h"
#include "rt/core/spsc_ring.h"
#include "rt/core/triple_buffer.h"
#include "rt/loop/operator_input.h"
#include "rt/loop/tick_record.h"

namespace sandrunner {

/// Half a second of ticks on their way to ordinary threads.
using TickRing = SpscRing<TickRecord, 2048>;

/// What passes between the two real-time threads.
struct PolicyExchange {
  TripleBuffer<PolicyInput> input;    ///< control to policy
  TripleBuffer<PolicyOutput> output;  ///< policy to control
};

/// Counts and durations of the control thread. Its own while it runs.
struct ControlDeadlines {
  std::uint64_t ticks = 0;    ///< slots that ran
  std::uint64_t skipped = 0;  ///< slots missed
  std::uint64_t longest_miss = 0;
  std::uint64_t releases = 0;  ///< of the policy
  LogHistogram late;           ///< start of a tick after its slot's time
  LogHistogram read, control, write;
  LogHistogram busy;  ///< the whole tick, to the end of its record
};

/// Called at the two ends of a real-time loop, from its thread; for tests that watch what happens
/// in between. Null: nothing.
struct LoopHooks {
  void (*entered)() noexcept = nullptr;
  void (*left)() noexcept = nullptr;
};

/// The 4 kHz loop: read, control, write, record, on the grid of slots, until the operator ends it.
class ControlThread {
 public:
  /// Everything must outlive the loop.
  ControlThread(RobotIo& io, const ControllerConfig& config, Mode start, OperatorInput& op,
                PolicyExchange& exchange, TickRing& ring, const std::atomic<bool>& interrupt);

  /// Runs from slot 0 at `start_ns` (CLOCK_MONOTONIC) on. Real-time safe but for its return.
  void run(std::int64_t start_ns, const LoopHooks& hooks) noexcept;

  const ControlDeadlines& deadlines() const noexcept { return deadlines_; }
  const Controller& controller() const noexcept { return controller_; }

 private:
  bool tick(std::uint64_t skipped, std::int64_t late_ns) noexcept;

  RobotIo& io_;
  Controller controller_;
  OperatorInput& operator_;
  PolicyExchange& exchange_;
  TickRing& ring_;
  const std::atomic<bool>& interrupt_;
  ControllerInput input_;
  ControllerOutput output_;
  TickRecord spare_;  // where a tick is recorded that finds the ring full
  ControlDeadlines deadlines_;
};

}  // namespace sandrunner
