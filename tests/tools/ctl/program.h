// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <unistd.h>

#include <string>
#include <utility>
#include <vector>

#include "rt/telemetry/dds/dds_config.h"
#include "tests/support/child_process.h"

namespace sandrunner::ctl {

/// A terminal without a window.
class Pty {
 public:
  Pty() {
    if (openpty(&master_, &slave_, nullptr, nullptr, nullptr) != 0) master_ = slave_ = -1;
    fcntl(master_, F_SETFD, FD_CLOEXEC);
    fcntl(slave_, F_SETFD, FD_CLOEXEC);
  }
  ~Pty() {
    hang_up();
    close(slave_);
  }
  Pty(const Pty&) = delete;
  Pty& operator=(const Pty&) = delete;

  bool type(const std::string& keys) const {
    return write(master_, keys.data(), keys.size()) == static_cast<ssize_t>(keys.size());
  }
  /// What was shown since the last call.
  std::string shown() const {
    std::string text;
    char buffer[4096];
    for (pollfd p{master_, POLLIN, 0}; poll(&p, 1, 0) > 0 && (p.revents & POLLIN) != 0;) {
      const ssize_t size = read(master_, buffer, sizeof buffer);
      if (size <= 0) break;
      text.append(buffer, static_cast<std::size_t>(size));
    }
    return text;
  }
  void hang_up() {
    if (master_ >= 0) close(master_);
    master_ = -1;
  }
  int slave() const { return slave_; }

 private:
  int master_ = -1, slave_ = -1;
};

/// sandrunner-ctl, running beside the test, with a terminal if it is given one.
class Program : public ChildProcess {
 public:
  Program(std::vector<std::string> words, const DdsConfig& config, const Pty* pty = nullptr)
      : ChildProcess(with_program(std::move(words), config),
                     {.folder = {}, .terminal = pty ? pty->slave() : -1}) {}

 private:
  static std::vector<std::string> with_program(std::vector<std::string> words,
                                               const DdsConfig& config) {
    words.insert(words.begin(), {SANDRUNNER_CTL, "--domain", std::to_string(config.domain)});
    return words;
  }
};

}  // namespace sandrunner::ctl
