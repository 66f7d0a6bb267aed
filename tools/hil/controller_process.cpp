// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/controller_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "rt/base/errors.h"

namespace sandrunner::hil {
namespace {

// Of stop_thread(). A process is not gone before its tracer has seen the end of its threads.
pid_t stopped_thread = 0;

void see_stopped_thread(int options) {
  int status = 0;
  while (stopped_thread > 0 && waitpid(stopped_thread, &status, options | __WALL) > 0) {
    if (WIFEXITED(status) || WIFSIGNALED(status)) stopped_thread = 0;
  }
}

}  // namespace

ControllerProcess::ControllerProcess(const std::vector<std::string>& command,
                                     const std::string& folder, const char* log) {
  // A path is one from here, not from the folder; a name is looked for in PATH.
  const bool is_path = command[0].find('/') != std::string::npos;
  const std::string program = is_path ? std::filesystem::absolute(command[0]).string() : command[0];
  std::vector<char*> words;
  for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addchdir_np(&files, folder.c_str());
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, log, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
  // Not the bench's priority: the controller has its own.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  const sched_param ordinary{};
  posix_spawnattr_setschedpolicy(&attributes, SCHED_OTHER);
  posix_spawnattr_setschedparam(&attributes, &ordinary);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSCHEDULER);
  const int error =
      posix_spawnp(&pid_, program.c_str(), &files, &attributes, words.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  if (error != 0) {
    pid_ = 0;
    throw InputError(fmt::format("{}: cannot be started ({})", program, strerror(error)));
  }
}

ControllerProcess::~ControllerProcess() {
  if (pid_ == 0 || ended()) return;
  kill(pid_, SIGKILL);
  see_stopped_thread(0);
  waitpid(pid_, nullptr, 0);
}

std::optional<int> ControllerProcess::ended() noexcept {
  int status = 0;
  see_stopped_thread(WNOHANG);
  if (!result_ && waitpid(pid_, &status, WNOHANG) == pid_) {
    result_ = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  return result_;
}

pid_t child_of(pid_t process) {
  pid_t child = 0;
  std::ifstream(fmt::format("/proc/{0}/task/{0}/children", process)) >> child;
  return child;
}

void stop_thread(pid_t process, const std::string& name) {
  for (const auto& task :
       std::filesystem::directory_iterator(fmt::format("/proc/{}/task", process))) {
    std::string found;
    std::getline(std::ifstream(task.path() / "comm"), found);
    if (found != name) continue;
    const pid_t thread = std::stoi(task.path().filename());
    if (ptrace(PTRACE_SEIZE, thread, nullptr, nullptr) == 0 &&
        ptrace(PTRACE_INTERRUPT, thread, nullptr, nullptr) == 0) {
      stopped_thread = thread;
      return;
    }
    throw InputError(
        fmt::format("controller: its thread {} cannot be stopped ({})", name, strerror(errno)));
  }
  throw InputError(fmt::format("controller: found no thread {}", name));
}

}  // namespace sandrunner::hil
