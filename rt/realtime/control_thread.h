// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>

#include "rt/core/log_histogram.h"
#include "rt/core/spsc_ring.h"
#include "rt/loop/control_loop.h"

namespace sandrunner {

/// Half a second of ticks on their way to ordinary threads.
inline constexpr std::size_t kTickRingSize = 2048;
using TickRing = SpscRing<TickRecord, kTickRingSize>;

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

/// When the control loop runs on a clock: on the grid of slots at 4 kHz, until the operator ends
/// it.
class ControlThread {
 public:
  /// `clock`: that of `loop`. Two that end it: `interrupt` is the user's, which no busy ordinary
  /// thread can keep from the robot; `end` the process's. Everything must outlive the thread.
  ControlThread(RobotIo& robot, ControlLoop& loop, OperatorInput& op, TickRing& ring, Clock& clock,
                const std::atomic<int>& interrupts, const std::atomic<bool>& end)
      : robot_(robot),
        loop_(loop),
        operator_(op),
        ring_(ring),
        clock_(clock),
        interrupts_(interrupts),
        end_(end) {}

  /// Runs from slot 0 at `start_ns` on, then switches the drives off. Real-time safe.
  void run(std::int64_t start_ns) noexcept;

  const ControlDeadlines& deadlines() const noexcept { return deadlines_; }
  /// Slots that ran, for the watchdog.
  const std::atomic<std::uint64_t>& ticks() const noexcept { return ticks_; }

 private:
  AfterTick tick(const SlotGrid::Slot& slot) noexcept;

  RobotIo& robot_;
  ControlLoop& loop_;
  OperatorInput& operator_;
  TickRing& ring_;
  Clock& clock_;
  const std::atomic<int>& interrupts_;
  const std::atomic<bool>& end_;
  TickRecord spare_;  // where a tick is recorded that finds the ring full
  ControlDeadlines deadlines_;
  std::atomic<std::uint64_t> ticks_{0};
};

}  // namespace sandrunner
