// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <poll.h>
#include <unistd.h>

#include <cstdio>
#include <string_view>

namespace sandrunner {

/// Whether a write to `file` would not wait: false for a terminal that was stopped with Ctrl-S and
/// for a full pipe. Waits at most `wait_ms` for it.
inline bool takes_output(int file, int wait_ms) noexcept {
  pollfd writable{file, POLLOUT, 0};
  return poll(&writable, 1, wait_ms) != 0;  // an error is the write's to report
}

/// Writes to the standard error. One that nobody takes any more (a terminal that hung up, a full
/// disk) is no error of the program. fmt::print throws there, which would end a run half-way. One
/// that takes nothing (a terminal stopped with Ctrl-S) loses the text after `wait_ms`: no thread
/// that has ticks to store may hang on it.
inline void to_standard_error(std::string_view text, int wait_ms = 100) noexcept {
  if (!takes_output(STDERR_FILENO, wait_ms)) return;
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

}  // namespace sandrunner
