// SPDX-License-Identifier: BSD-3-Clause
// Programs that tests start: beside the test, or until their end.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

namespace sandrunner {

/// What a process left behind.
struct Ended {
  int code = -1;         ///< exit code; 128 + the signal that killed it; -1: it did not start
  std::string out, err;  ///< what it printed on standard output and standard error
};

inline std::ostream& operator<<(std::ostream& stream, const Ended& ended) {
  return stream << "exit code " << ended.code << "\n" << ended.out << ended.err;
}

struct ChildOptions {
  std::string folder;  ///< it works in; empty: the test's own
  int terminal = -1;  ///< terminal that is its standard input and output; -1: /dev/null, and a pipe
};

/// A process that runs beside the test and is killed with this object. It starts with every signal
/// at its default. What it prints waits in pipes (64 kB) until one of the waits below reads it.
class ChildProcess {
 public:
  /// `words`: the program, found as the shell finds it, and its arguments.
  explicit ChildProcess(std::vector<std::string> words, const ChildOptions& options = {}) {
    int out[2] = {-1, -1}, err[2] = {-1, -1};
    if (pipe2(out, O_CLOEXEC) != 0 || pipe2(err, O_CLOEXEC) != 0) ADD_FAILURE() << "no pipes";
    out_ = out[0];
    err_ = err[0];
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    if (options.terminal >= 0) {
      posix_spawn_file_actions_adddup2(&actions, options.terminal, STDIN_FILENO);
      posix_spawn_file_actions_adddup2(&actions, options.terminal, STDOUT_FILENO);
    } else {
      posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
      posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
    }
    posix_spawn_file_actions_adddup2(&actions, err[1], STDERR_FILENO);
    // Cyclone DDS does not close its sockets on exec.
    posix_spawn_file_actions_addclosefrom_np(&actions, 3);
    if (!options.folder.empty()) {
      posix_spawn_file_actions_addchdir_np(&actions, options.folder.c_str());
    }
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t every;
    sigfillset(&every);
    posix_spawnattr_setsigdefault(&attributes, &every);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
    const int error = posix_spawnp(&pid_, words.at(0).c_str(), &actions, &attributes,
                                   pointers(words).data(), environ);
    if (error != 0) {
      ADD_FAILURE() << words[0] << ": " << std::strerror(error);
      pid_ = -1;
    } else {
      // glibc 2.36 declares pidfd_open for C only.
      pidfd_ = static_cast<int>(syscall(SYS_pidfd_open, pid_, 0));
    }
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    close(out[1]);
    close(err[1]);
  }
  ~ChildProcess() {
    signal(SIGKILL);
    if (pid_ > 0) waitpid(pid_, nullptr, 0);
    for (const int file : {out_, err_, pidfd_}) {
      if (file >= 0) close(file);
    }
  }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  pid_t pid() const { return pid_; }  ///< -1 after `wait`
  void signal(int number) const {
    if (pid_ > 0) kill(pid_, number);
  }
  /// Closes the reading end of its standard output.
  void close_out() {
    close(out_);
    out_ = -1;
  }
  /// Waits until it has printed a line that begins like this; false if it ended without.
  bool wait_for(const std::string& line) {
    const auto is_there = [&] {
      return ("\n" + ended_.out).find("\n" + line) != std::string::npos;
    };
    while (!is_there()) {
      if (!read_some()) return is_there();
    }
    return true;
  }
  /// Whether this is in what it has printed on standard output so far; does not wait.
  bool has_printed(const std::string& text) {
    while (read_some(0)) {
    }
    return ended_.out.find(text) != std::string::npos;
  }
  /// Waits for its end.
  const Ended& wait() {
    while (read_some()) {
    }
    int status = 0;
    if (pid_ > 0 && waitpid(pid_, &status, 0) == pid_) {
      ended_.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    pid_ = -1;
    return ended_;
  }

 private:
  static std::vector<char*> pointers(std::vector<std::string>& words) {
    std::vector<char*> all;
    for (std::string& word : words) all.push_back(word.data());
    all.push_back(nullptr);
    return all;
  }

  /// Waits for more output or the end, for this long at most (-1: without limit); false at the end
  /// and if nothing came. Does not wait for processes that this one leaves behind with its pipes.
  bool read_some(int timeout_ms = -1) {
    if (pid_ <= 0) return false;
    // Its end first: what it printed before is then seen in the same call.
    pollfd files[] = {{pidfd_, POLLIN, 0}, {out_, POLLIN, 0}, {err_, POLLIN, 0}};
    const int found = poll(files, 3, timeout_ms);
    if (found <= 0) return found < 0 && errno == EINTR;
    const bool out = read_from(files[1].revents, out_, ended_.out);
    const bool err = read_from(files[2].revents, err_, ended_.err);
    return out || err || files[0].revents == 0;
  }
  /// Reads what a poll found; closes a pipe that nobody writes to any more.
  static bool read_from(short found, int& file, std::string& text) {
    if (found == 0) return false;
    char buffer[4096];
    const ssize_t size = read(file, buffer, sizeof buffer);
    if (size <= 0) {
      close(file);
      file = -1;
      return false;
    }
    text.append(buffer, static_cast<std::size_t>(size));
    return true;
  }

  pid_t pid_ = -1;
  int out_ = -1, err_ = -1, pidfd_ = -1;
  Ended ended_;
};

/// Runs a program until its end.
inline Ended run_process(std::vector<std::string> words, const ChildOptions& options = {}) {
  return ChildProcess(std::move(words), options).wait();
}

/// Runs a line of the shell until its end.
inline Ended run_shell(const std::string& line, const ChildOptions& options = {}) {
  return run_process({"sh", "-c", line}, options);
}

}  // namespace sandrunner
