// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <signal.h>

#include <cstdint>
#include <functional>

namespace sandrunner::ctl {

/// Nanoseconds of the steady clock.
std::int64_t steady_ns() noexcept;

inline constexpr std::int64_t kMs_ns = 1'000'000;
inline constexpr std::int64_t kSecond_ns = 1'000'000'000;
/// How often topics are polled.
inline constexpr std::int64_t kLook_ns = 10 * kMs_ns;

/// Blocks SIGINT, SIGTERM and SIGHUP in this thread and all threads that start after it: they are
/// noticed where the program waits, so that it always ends in good order. Also ignores SIGPIPE:
/// when the output is closed, a write fails.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  /// Waits this long, or until a signal comes. Returns whether one has come; after that it does not
  /// wait any more.
  bool wait(std::int64_t duration_ns);
  /// Waits until `holds()`, for a signal, or for this long. Returns whether it held.
  bool wait_until(std::int64_t duration_ns, const std::function<bool()>& holds);
  /// Whether a signal has come.
  bool came();
  /// Readable when a signal has come.
  int fd() const noexcept { return fd_; }

 private:
  sigset_t signals_;
  int fd_;
};

}  // namespace sandrunner::ctl
