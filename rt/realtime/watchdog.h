// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>

#include "rt/core/robot_io.h"
#include "rt/loop/clock.h"

namespace sandrunner {

/// How long the control thread may not tick while the machine runs: longer than any stall that the
/// safety gate tolerates. Drives have switched off by then through their own time-out (50 ms unless
/// set, at most 100).
inline constexpr std::int64_t kWatchdog_ns = 100'000'000;

/// The last line of defence within this process: when the control thread hangs, cuts the
/// drives for good, and again in each look until it ticks, because a frame may be lost. It has a
/// thread of its own, above the control thread's priority. A stall of the whole machine stops the
/// watchdog too; the control thread judges that one.
class Watchdog {
 public:
  /// `ticks` grows with every tick of the control thread. All must outlive the watchdog.
  Watchdog(RobotIo& robot, const std::atomic<std::uint64_t>& ticks, Clock& clock)
      : robot_(robot), ticks_(ticks), clock_(clock) {}

  /// Watches from `start_ns` on until stop(). Real-time safe.
  void run(std::int64_t start_ns) noexcept;
  void stop() noexcept { stop_.store(true, std::memory_order_relaxed); }

  /// One look; the first one is given the time from which it watches. Cuts the drives if need be.
  void look(std::int64_t now_ns) noexcept;
  bool has_cut() const noexcept { return cut_.load(std::memory_order_relaxed); }
  /// Longest time between two looks: for this long nothing watched the control thread.
  std::int64_t longest_gap_ns() const noexcept {
    return longest_gap_ns_.load(std::memory_order_relaxed);
  }

 private:
  RobotIo& robot_;
  const std::atomic<std::uint64_t>& ticks_;
  Clock& clock_;
  std::atomic<bool> stop_{false}, cut_{false};
  std::atomic<std::int64_t> longest_gap_ns_{0};
  std::uint64_t seen_ = 0;
  std::int64_t looked_ns_ = 0, alive_ns_ = 0;
  bool watching_ = false;
};

}  // namespace sandrunner
