// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>

namespace sandrunner {

/// The two clocks of a run.
enum class RunClock : std::uint8_t {
  kLockstep,  ///< one thread, simulated time
  kRealtime,  ///< the threads of the robot on the system's clock
};

/// "lockstep", "realtime".
constexpr const char* clock_name(RunClock clock) noexcept {
  return clock == RunClock::kLockstep ? "lockstep" : "realtime";
}

/// Time as a loop sees it. Used by one thread.
class Clock {
 public:
  virtual ~Clock() = default;
  virtual std::int64_t now_ns() noexcept = 0;
  /// Returns at once if it is already later.
  virtual void sleep_until(std::int64_t time_ns) noexcept = 0;
};

/// Time that passes only on command: of lockstep, and of tests of the threaded loop.
class ManualClock final : public Clock {
 public:
  std::int64_t now_ns() noexcept override { return now_ns_; }
  void sleep_until(std::int64_t time_ns) noexcept override { now_ns_ = std::max(now_ns_, time_ns); }
  void advance(std::int64_t duration_ns) noexcept { now_ns_ += duration_ns; }

 private:
  std::int64_t now_ns_ = 0;
};

}  // namespace sandrunner
