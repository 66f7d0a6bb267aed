// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/guard_process.h"

#include <poll.h>
#include <signal.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <initializer_list>

#include "rt/base/process_name.h"

namespace sandrunner {

void become_guard(const char* name) noexcept {
  rename_process(name);
  setsid();
  // A stop is for the controller: it lets the robot down, for which it needs its guards.
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP, SIGPIPE}) {
    signal(number, SIG_IGN);
  }
}

// glibc 2.36 declares pidfd_open for C only.
int open_process(pid_t pid) noexcept { return static_cast<int>(syscall(SYS_pidfd_open, pid, 0)); }

bool process_runs(int process) noexcept {
  pollfd file{.fd = process, .events = POLLIN, .revents = 0};
  return poll(&file, 1, 0) == 0;
}

}  // namespace sandrunner
