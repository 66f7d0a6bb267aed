// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/signals.h"

#include <csignal>

namespace sandrunner {
namespace {

constexpr int kEnd = SIGUSR1;  // wakes the thread for its end

}  // namespace

SignalWatch::SignalWatch() {
  std::signal(SIGPIPE, SIG_IGN);
  sigemptyset(&watched_);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction inherited;
    sigaction(number, nullptr, &inherited);
    if (inherited.sa_handler != SIG_IGN) sigaddset(&watched_, number);  // nohup, a shell's &
  }
  sigaddset(&watched_, kEnd);
  pthread_sigmask(SIG_BLOCK, &watched_, nullptr);
  thread_ = std::thread([this] {
    int number;
    while (sigwait(&watched_, &number) == 0 && !end_) {
      if (number != kEnd) interrupted_ = true;
    }
  });
}

SignalWatch::~SignalWatch() {
  end_ = true;
  pthread_kill(thread_.native_handle(), kEnd);
  thread_.join();
  pthread_sigmask(SIG_UNBLOCK, &watched_, nullptr);
}

}  // namespace sandrunner
