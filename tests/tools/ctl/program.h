// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>
#include <vector>

#include "rt/telemetry/dds/dds_config.h"

namespace sandrunner::ctl {

/// What a program said until its end.
struct Ended {
  int code = -1;  ///< exit code; 128 + the signal that killed it
  std::string out, err;
};

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
class Program {
 public:
  Program(std::vector<std::string> words, const DdsConfig& config, const Pty* pty = nullptr) {
    words.insert(words.begin(), {SANDRUNNER_CTL, "--domain", std::to_string(config.domain)});
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    int out[2], err[2];
    if (pipe2(out, O_CLOEXEC) != 0 || pipe2(err, O_CLOEXEC) != 0) return;
    out_ = out[0];
    err_ = err[0];
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    if (pty) {
      posix_spawn_file_actions_adddup2(&actions, pty->slave(), STDIN_FILENO);
    } else {
      posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    }
    posix_spawn_file_actions_adddup2(&actions, pty ? pty->slave() : out[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, err[1], STDERR_FILENO);
    // Cyclone DDS does not close its sockets on exec.
    posix_spawn_file_actions_addclosefrom_np(&actions, 3);
    if (posix_spawn(&pid_, argv[0], &actions, nullptr, argv.data(), environ) != 0) pid_ = -1;
    posix_spawn_file_actions_destroy(&actions);
    close(out[1]);
    close(err[1]);
  }
  ~Program() {
    signal(SIGKILL);
    wait();
    close(out_);
    close(err_);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void signal(int number) {
    if (pid_ > 0) kill(pid_, number);
  }
  /// Closes the reading end of its standard output.
  void close_out() {
    close(out_);
    out_ = -1;
  }
  /// Waits for its end.
  const Ended& wait() {
    read_all(out_, ended_.out);
    read_all(err_, ended_.err);
    int status = 0;
    if (pid_ > 0 && waitpid(pid_, &status, 0) == pid_) {
      ended_.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    pid_ = -1;
    return ended_;
  }

 private:
  static void read_all(int fd, std::string& text) {
    char buffer[4096];
    for (ssize_t size; fd >= 0 && (size = read(fd, buffer, sizeof buffer)) > 0;) {
      text.append(buffer, static_cast<std::size_t>(size));
    }
  }

  pid_t pid_ = -1;
  int out_ = -1, err_ = -1;
  Ended ended_;
};

}  // namespace sandrunner::ctl
