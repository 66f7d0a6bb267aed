// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/signals.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>

#include "rt/base/clock_ns.h"
#include "rt/base/standard_error.h"

namespace sandrunner {
namespace {

// A shell and the kernel both send a closed terminal's, timeout(1) one to its child and one to its
// group. A person's second Ctrl-C takes longer.
constexpr std::int64_t kTogether_ns = 100'000'000;

const int kEndSignal = SIGRTMIN;  // wakes the thread for its end

constexpr std::array kCrashes = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP, SIGSYS};
constexpr std::array kIgnored = {SIGPIPE, SIGXFSZ, SIGTTOU, SIGTTIN};
// By default they do nothing, or they cannot be caught.
constexpr std::array kHarmless = {SIGCHLD, SIGCONT, SIGURG, SIGWINCH, SIGKILL, SIGSTOP};

template <typename List>
bool contains(const List& list, int number) {
  return std::find(list.begin(), list.end(), number) != list.end();
}

std::atomic<RobotIo*> robot_of_a_crash{nullptr};
static_assert(std::atomic<RobotIo*>::is_always_lock_free);

// Its action is reset: on return the process ends as it would have without it.
void crash(int) {
  if (RobotIo* const robot = robot_of_a_crash.load()) robot->cut_drives();
}

/// Ends the process as the signal would have: who waits for it learns of which one. Whatever the
/// start had begun, drives are off: only a run enables them.
[[noreturn]] void end_by(int number) {
  to_standard_error("sandrunner: a signal ended the start; no drive was switched on\n");
  if (number == SIGTSTP) number = SIGINT;  // it would stop the process
  std::signal(number, SIG_DFL);
  sigset_t only;
  sigemptyset(&only);
  sigaddset(&only, number);
  pthread_sigmask(SIG_UNBLOCK, &only, nullptr);
  raise(number);
  _exit(128 + number);
}

}  // namespace

SignalWatch::SignalWatch() {
  for (const int number : kIgnored) std::signal(number, SIG_IGN);
  sigemptyset(&watched_);
  for (int number = 1; number <= SIGRTMAX; ++number) {
    if (contains(kCrashes, number) || contains(kIgnored, number) || contains(kHarmless, number)) {
      continue;
    }
    struct sigaction inherited;
    if (sigaction(number, nullptr, &inherited) != 0) continue;  // the C library's own
    if (inherited.sa_handler == SIG_IGN) {
      // A shell that starts a script's command with & has it ignore SIGINT and SIGQUIT: a robot
      // must stop all the same.
      if (number == SIGHUP) continue;  // nohup
      std::signal(number, SIG_DFL);
    }
    sigaddset(&watched_, number);
  }
  sigaddset(&watched_, kEndSignal);
  pthread_sigmask(SIG_BLOCK, &watched_, nullptr);
  thread_ = std::thread([this] {
    int number;
    std::int64_t last_ns = 0;
    while (sigwait(&watched_, &number) == 0 && !end_) {
      Phase phase = Phase::kStart;
      if (phase_.compare_exchange_strong(phase, Phase::kEnd)) end_by(number);
      const std::int64_t now_ns = clock_ns(CLOCK_MONOTONIC);
      const bool another = now_ns - last_ns > kTogether_ns && number != SIGHUP;
      if (interrupts_ == 0 || another) ++interrupts_;
      last_ns = now_ns;
    }
  });
  pthread_setname_np(thread_.native_handle(), "signals-start");
}

SignalWatch::~SignalWatch() {
  end_ = true;
  pthread_kill(thread_.native_handle(), kEndSignal);
  thread_.join();
  pthread_sigmask(SIG_UNBLOCK, &watched_, nullptr);
}

void SignalWatch::run_begins() noexcept {
  Phase phase = Phase::kStart;
  if (phase_.compare_exchange_strong(phase, Phase::kRun)) {
    pthread_setname_np(thread_.native_handle(), kSignalsThread);
    return;
  }
  while (phase == Phase::kEnd) pause();  // until the process has ended
}

CutInACrash::CutInACrash(RobotIo& robot) {
  robot_of_a_crash = &robot;
  for (const int number : kCrashes) {
    struct sigaction action{};
    action.sa_handler = crash;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigaction(number, &action, nullptr);
  }
}

CutInACrash::~CutInACrash() {
  for (const int number : kCrashes) std::signal(number, SIG_DFL);
  robot_of_a_crash = nullptr;
}

}  // namespace sandrunner
