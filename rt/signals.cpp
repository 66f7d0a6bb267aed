// SPDX-License-Identifier: BSD-3-Clause
#include "rt/signals.h"

#include <csignal>

namespace sandrunner {

SignalWatch::SignalWatch() {
  std::signal(SIGPIPE, SIG_IGN);
  sigemptyset(&watched_);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&watched_, number);
  pthread_sigmask(SIG_BLOCK, &watched_, nullptr);
  thread_ = std::thread([this] {
    int number;
    while (sigwait(&watched_, &number) == 0 && !end_) interrupted_ = true;
  });
}

SignalWatch::~SignalWatch() {
  end_ = true;
  pthread_kill(thread_.native_handle(), SIGTERM);
  thread_.join();
  pthread_sigmask(SIG_UNBLOCK, &watched_, nullptr);
}

}  // namespace sandrunner
