// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>

namespace sandrunner {

/// Lockstep at the pace of the clock, so that there is something to see: holds the thread of the
/// ticks between two of them. Nothing of what the ticks compute depends on it.
class ViewPace {
 public:
  /// The first of the `interrupts` ends every wait.
  explicit ViewPace(const std::atomic<int>& interrupts) : interrupts_(interrupts) {}

  /// After every tick, from the thread of the ticks: returns when the next one is due.
  void wait();

  // From any thread:
  /// `rate`: times the robot's own speed.
  void set_rate(double rate);
  void pause(bool on);
  /// This many ticks more, then it pauses.
  void step(int ticks);

  struct Status {
    double rate = 1.0;
    bool paused = false;
  };
  Status status() const;

 private:
  using Clock = std::chrono::steady_clock;

  const std::atomic<int>& interrupts_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  Status status_;
  int steps_ = 0;  // that are still to be done in a pause
  Clock::time_point due_{};
};

}  // namespace sandrunner
