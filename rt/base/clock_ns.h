// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <ctime>

namespace sandrunner {

/// One of the kernel's clocks in nanoseconds. CLOCK_MONOTONIC, and CLOCK_REALTIME, which is that of
/// the stamps of received CAN frames, need no system call: the kernel maps both into the process.
inline std::int64_t clock_ns(clockid_t clock) noexcept {
  timespec t;
  clock_gettime(clock, &t);
  return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

/// The same in seconds.
inline double clock_s(clockid_t clock) noexcept {
  return 1e-9 * static_cast<double>(clock_ns(clock));
}

}  // namespace sandrunner
