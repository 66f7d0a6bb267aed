// SPDX-License-Identifier: BSD-3-Clause
#include "tools/ctl/interrupt.h"

#include <poll.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <stdexcept>

#include "rt/base/clock_ns.h"

namespace sandrunner::ctl {

std::int64_t steady_ns() noexcept { return clock_ns(CLOCK_MONOTONIC); }

Interrupt::Interrupt() {
  std::signal(SIGPIPE, SIG_IGN);
  sigemptyset(&signals_);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals_, number);
  pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  fd_ = signalfd(-1, &signals_, SFD_CLOEXEC);
  if (fd_ < 0) throw std::runtime_error("signalfd failed");
}

Interrupt::~Interrupt() { close(fd_); }

// The signal stays pending and the descriptor readable: nothing has to be remembered.
bool Interrupt::wait(std::int64_t duration_ns) {
  pollfd p{fd_, POLLIN, 0};
  const std::int64_t wait_ns = std::max<std::int64_t>(duration_ns, 0);
  const timespec timeout{wait_ns / kSecond_ns, wait_ns % kSecond_ns};
  return ppoll(&p, 1, &timeout, nullptr) == 1;
}

bool Interrupt::came() { return wait(0); }

bool Interrupt::wait_until(std::int64_t duration_ns, const std::function<bool()>& holds) {
  const std::int64_t end_ns = steady_ns() + duration_ns;
  while (!holds()) {
    if (steady_ns() > end_ns || wait(kLook_ns)) return false;
  }
  return true;
}

}  // namespace sandrunner::ctl
