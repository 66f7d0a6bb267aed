// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>
#include <vector>

namespace sandrunner {

/// A program that runs beside the test; what it prints is kept.
class Child {
 public:
  explicit Child(std::vector<std::string> words) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) return;
    out_ = ends[0];
    std::vector<char*> argv;
    argv.reserve(words.size() + 1);
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    // Cyclone DDS does not close its sockets on exec.
    posix_spawn_file_actions_addclosefrom_np(&actions, 3);
    if (posix_spawn(&pid_, argv[0], &actions, nullptr, argv.data(), environ) != 0) pid_ = -1;
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
  }
  ~Child() {
    signal(SIGKILL);
    wait();
    close(out_);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  void signal(int number) {
    if (pid_ > 0) kill(pid_, number);
  }
  /// Reads until it has printed a line that begins like this, or ended.
  bool wait_for(const std::string& line) {
    while (("\n" + text_).find("\n" + line) == std::string::npos) {
      if (!read_some()) return false;
    }
    return true;
  }
  /// All that it printed; waits for its end.
  const std::string& wait() {
    while (read_some()) {
    }
    int status = 0;
    if (pid_ > 0 && waitpid(pid_, &status, 0) == pid_ && WIFEXITED(status)) {
      code_ = WEXITSTATUS(status);
    }
    pid_ = -1;
    return text_;
  }
  /// Its exit code; waits for its end. -1: killed.
  int code() {
    wait();
    return code_;
  }
  /// The number after this word, in all that it printed; -1 without.
  double number(const std::string& word) {
    const std::size_t at = ("\n" + wait()).find(word + " ");
    return at == std::string::npos ? -1.0 : std::stod(("\n" + text_).substr(at + word.size()));
  }

 private:
  bool read_some() {
    char buffer[512];
    const ssize_t size = read(out_, buffer, sizeof buffer);
    if (size > 0) text_.append(buffer, static_cast<std::size_t>(size));
    return size > 0;
  }

  pid_t pid_ = -1;
  int out_ = -1;
  int code_ = -1;
  std::string text_;
};

}  // namespace sandrunner
