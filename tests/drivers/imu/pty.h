// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <asm/ioctls.h>
#include <asm/termbits.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace sandrunner {

/// A serial line without hardware: the test holds its far end, and `path()` is the near one. What
/// one end writes arrives at the other a little later, by a thread of the kernel.
class Pty {
 public:
  Pty() {
    master_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    char name[64] = "";
    if (grantpt(master_) != 0 || unlockpt(master_) != 0 ||
        ptsname_r(master_, name, sizeof(name)) != 0) {
      ADD_FAILURE() << "no pseudo-terminal";
    }
    path_ = name;
  }
  ~Pty() { unplug(); }
  Pty(const Pty&) = delete;
  Pty& operator=(const Pty&) = delete;

  const std::string& path() const { return path_; }

  void write(std::span<const std::uint8_t> bytes) const {
    ASSERT_EQ(::write(master_, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }

  /// What the near end has written; waits for it, but not for long.
  std::vector<std::uint8_t> read(int timeout_ms) const {
    pollfd wanted{.fd = master_, .events = POLLIN, .revents = 0};
    ::poll(&wanted, 1, timeout_ms);
    std::vector<std::uint8_t> bytes(4096);
    const ssize_t count = ::read(master_, bytes.data(), bytes.size());
    bytes.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
    return bytes;
  }

  /// The speed that the near end is set to.
  unsigned baud() const {
    termios2 line{};
    return ioctl(master_, TCGETS2, &line) == 0 ? line.c_ospeed : 0;
  }

  void unplug() {
    if (master_ >= 0) ::close(master_);
    master_ = -1;
  }

 private:
  int master_ = -1;
  std::string path_;
};

}  // namespace sandrunner
