// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <signal.h>

#include <atomic>
#include <thread>

#include "rt/core/robot_io.h"

namespace sandrunner {

/// Name of the thread that waits for signals, once the robot may move.
inline constexpr const char* kSignalsThread = "signals-run";

/// What the process does about signals while it has a robot. It blocks every signal that would end
/// or stop it (Ctrl-C, Ctrl-\, Ctrl-Z, a closed terminal, a timer, a limit of processor time, ...)
/// in all threads that start later, and waits for them in a thread of its own. So no code runs in a
/// signal handler, no system call of another thread is interrupted, and the robot lies down first.
/// Until run_begins() there is nothing to let down: a signal ends the process at once, whatever the
/// start waits for. Exception: a SIGHUP that was ignored from the start (nohup). It ignores signals
/// that stand for an error of a write: SIGPIPE, SIGXFSZ, SIGTTOU, SIGTTIN. For SIGKILL and SIGSTOP,
/// which no program can catch, there are the drives' own time-out and the guards of drivers/.
class SignalWatch {
 public:
  SignalWatch();
  ~SignalWatch();
  SignalWatch(const SignalWatch&) = delete;
  SignalWatch& operator=(const SignalWatch&) = delete;

  /// The robot may move from now on: signals count, and end nothing by themselves.
  void run_begins() noexcept;

  /// How often a person or a service has asked for the end. Signals that come together count once,
  /// as those of a closed terminal do, and a hang-up is never more than the first.
  const std::atomic<int>& interrupts() const noexcept { return interrupts_; }

 private:
  enum class Phase { kStart, kRun, kEnd };

  sigset_t watched_;
  std::atomic<Phase> phase_{Phase::kStart};
  std::atomic<int> interrupts_{0};
  std::atomic<bool> end_{false};
  std::thread thread_;
};

/// As long as it lives, a crash (SIGSEGV, SIGABRT, ...) cuts the drives of `robot` in its handler
/// and then ends the process as it would have. One at a time.
class CutInACrash {
 public:
  explicit CutInACrash(RobotIo& robot);
  ~CutInACrash();
  CutInACrash(const CutInACrash&) = delete;
  CutInACrash& operator=(const CutInACrash&) = delete;
};

}  // namespace sandrunner
