// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cerrno>
#include <cstdint>
#include <ctime>

#include "rt/loop/clock.h"

namespace sandrunner {

/// CLOCK_MONOTONIC in nanoseconds. No system call: the kernel maps it into the process.
inline std::int64_t monotonic_ns() noexcept {
  timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

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
