// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ctime>

namespace sandrunner::bench {

/// Processor time of the calling thread, s: what others do on the machine is not in it.
inline double thread_cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Time since some moment, s.
inline double wall_s() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace sandrunner::bench
