// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/guard_process.h"

#include <fmt/format.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <initializer_list>

#include "rt/base/errors.h"
#include "rt/base/process_name.h"

namespace sandrunner {

void* map_shared(std::size_t size, const char* key) {
  void* const memory =
      mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) {
    throw InputError(fmt::format("{}: found no memory to share ({})", key, std::strerror(errno)));
  }
  return memory;
}

pid_t fork_process(const char* key) {
  const pid_t pid = fork();
  if (pid < 0) {
    throw InputError(fmt::format("{}: no process can be started ({})", key, std::strerror(errno)));
  }
  return pid;
}

void become_guard(const char* name) noexcept {
  rename_process(name);
  setsid();
  // A stop is for the controller: it lets the robot down, for which it needs its guards.
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP, SIGPIPE}) {
    signal(number, SIG_IGN);
  }
}

bool become_real_time(int priority) noexcept {
  mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT);
  const sched_param parameters{.sched_priority = priority};
  return sched_setscheduler(0, SCHED_FIFO, &parameters) == 0;
}

// glibc 2.36 declares pidfd_open for C only.
int open_process(pid_t pid) noexcept { return static_cast<int>(syscall(SYS_pidfd_open, pid, 0)); }

bool process_runs(int process) noexcept {
  pollfd file{.fd = process, .events = POLLIN, .revents = 0};
  return poll(&file, 1, 0) == 0;
}

void pause_ns(std::int64_t time_ns) noexcept {
  const timespec pause{.tv_sec = 0, .tv_nsec = time_ns};
  nanosleep(&pause, nullptr);
}

void write_text(std::string_view text, std::span<char> place) noexcept {
  const std::size_t size = std::min(text.size(), place.size() - 1);
  std::copy_n(text.begin(), size, place.begin());
  place[size] = '\0';
}

}  // namespace sandrunner
