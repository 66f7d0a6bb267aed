// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/process_name.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>

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

void rename_process(const char* name) noexcept {
  prctl(PR_SET_NAME, name);
  const std::span<char> line = command_line();
  if (line.empty()) return;
  std::memset(line.data(), 0, line.size());
  std::memcpy(line.data(), name, std::min(std::strlen(name), line.size() - 1));
}

}  // namespace sandrunner
