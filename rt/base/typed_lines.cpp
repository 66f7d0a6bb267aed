// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/typed_lines.h"

#include <poll.h>
#include <unistd.h>

namespace sandrunner {

std::optional<std::string> Lines::next() {
  pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  if (!ended_ && typed_.find('\n') == std::string::npos && poll(&input, 1, 0) > 0) {
    char bytes[256];
    const ssize_t count = read(STDIN_FILENO, bytes, sizeof bytes);
    if (count > 0) {
      typed_.append(bytes, static_cast<std::size_t>(count));
    } else {
      ended_ = true;
    }
  }
  std::size_t end = typed_.find('\n');
  if (end == std::string::npos) {
    if (!ended_ || typed_.empty()) return std::nullopt;
    end = typed_.size();
  }
  std::string line = typed_.substr(0, end);
  typed_.erase(0, end + 1);
  return line;
}

}  // namespace sandrunner
