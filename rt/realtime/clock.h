// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cerrno>
#include <cstdint>
#include <ctime>

#include "rt/base/clock_ns.h"
#include "rt/loop/clock.h"

namespace sandrunner {

/// CLOCK_MONOTONIC in nanoseconds.
inline std::int64_t monotonic_ns() noexcept { return clock_ns(CLOCK_MONOTONIC); }

/// Sleeps until CLOCK_MONOTONIC shows `time_ns`; returns at once if it already does.
inline void sleep_until(std::int64_t time_ns) noexcept {
  const timespec t{.tv_sec = time_ns / 1'000'000'000, .tv_nsec = time_ns % 1'000'000'000};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
  }
}

/// CLOCK_MONOTONIC. Has no state: any number of threads may share one.
class SystemClock : public Clock {
 public:
  std::int64_t now_ns() noexcept override { return monotonic_ns(); }
  void sleep_until(std::int64_t time_ns) noexcept override { sandrunner::sleep_until(time_ns); }
};

}  // namespace sandrunner
