// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <signal.h>

#include <atomic>
#include <thread>

namespace sandrunner {

/// Takes SIGINT, SIGTERM and SIGHUP (but for those that were ignored from the start, as by nohup)
/// away from all threads that start after it, and waits for them in a thread of its own: no code
/// runs in a signal handler, no system call of another thread is interrupted. Also ignores SIGPIPE:
/// a closed standard output is an error of a write, not the end of a process that controls a robot.
class SignalWatch {
 public:
  SignalWatch();
  ~SignalWatch();
  SignalWatch(const SignalWatch&) = delete;
  SignalWatch& operator=(const SignalWatch&) = delete;

  /// True once any of them has come.
  const std::atomic<bool>& interrupted() const noexcept { return interrupted_; }

 private:
  sigset_t watched_;
  std::atomic<bool> interrupted_{false}, end_{false};
  std::thread thread_;
};

}  // namespace sandrunner
