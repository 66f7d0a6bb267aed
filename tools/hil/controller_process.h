// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace sandrunner::hil {

/// The controller as a process of its own; in sandrunner-bench, the emulated robot.
class ControllerProcess {
 public:
  /// Starts it in `folder`. A program with a slash in its name is a path from the caller's own
  /// folder, one without is looked for in PATH. What it prints goes into `log`, a path from
  /// `folder`. Throws InputError.
  ControllerProcess(const std::vector<std::string>& command, const std::string& folder,
                    const char* log = "log.txt");
  /// Kills it if it still runs.
  ~ControllerProcess();
  ControllerProcess(const ControllerProcess&) = delete;
  ControllerProcess& operator=(const ControllerProcess&) = delete;

  pid_t pid() const noexcept { return pid_; }
  /// Its exit code once it has ended, -1 if a signal ended it.
  std::optional<int> ended() noexcept;

 private:
  pid_t pid_ = 0;
  std::optional<int> result_;
};

/// The first child of a process; 0: it has none.
pid_t child_of(pid_t process);

/// Stops one thread of a process that this one has started, for good: as long as this process
/// lives. Throws InputError if it has none of this name.
void stop_thread(pid_t process, const std::string& name);

}  // namespace sandrunner::hil
