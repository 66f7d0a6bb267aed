// SPDX-License-Identifier: BSD-3-Clause
// What a thread does that a real-time loop must not: counted by functions and a system-call filter
// that this test program puts in the way of the C library and of the kernel.
#pragma once

#include <string>

namespace sandrunner {

/// What one thread did between begin_watch() and end_watch().
struct WatchedDeeds {
  int allocations = 0;  ///< malloc and its family
  int frees = 0;
  int locks = 0;         ///< mutexes, condition variables, semaphores
  int system_calls = 0;  ///< other than clock_nanosleep
  long last_system_call = -1;
  long page_faults = 0;  ///< minor and major
  std::string text() const;
};

/// From the thread to be watched. The filter stays on the thread for good, its counting does not.
void begin_watch() noexcept;
WatchedDeeds end_watch() noexcept;

/// False where the kernel lets nobody filter system calls: they are not counted then.
bool can_filter_system_calls() noexcept;

}  // namespace sandrunner
