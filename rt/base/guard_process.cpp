// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/guard_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <initializer_list>

#include "rt/base/errors.h"

namespace sandrunner {
namespace {

/// Where the kernel looks for the command line of this process; empty: it does not say.
std::span<char> command_line() noexcept {
  char text[2048];
  const int file = open("/proc/self/stat", O_RDONLY | O_CLOEXEC);
  const ssize_t size = file < 0 ? -1 : read(file, text, sizeof text - 1);
  if (file >= 0) close(file);
  if (size <= 0) return {};
  text[size] = '\0';
  // The second field, a name in parentheses, may contain anything; the third follows it.
  const char* field = std::strrchr(text, ')');
  constexpr int kStart = 48, kEnd = 49;  // proc(5)
  std::uintptr_t start = 0, end = 0;
  for (int number = 3; field && number <= kEnd; ++number) {
    field = std::strchr(field + 1, ' ');
    if (!field) return {};
    if (number == kStart) start = std::strtoull(field + 1, nullptr, 10);
    if (number == kEnd) end = std::strtoull(field + 1, nullptr, 10);
  }
  if (start == 0 || end <= start) return {};
  // The kernel says it as a number. NOLINTNEXTLINE(performance-no-int-to-ptr)
  return {reinterpret_cast<char*>(start), end - start};
}

}  // namespace

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

void rename_process(const char* name) noexcept {
  prctl(PR_SET_NAME, name);
  const std::span<char> line = command_line();
  if (line.empty()) return;
  std::memset(line.data(), 0, line.size());
  std::memcpy(line.data(), name, std::min(std::strlen(name), line.size() - 1));
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
