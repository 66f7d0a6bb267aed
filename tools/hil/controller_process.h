// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace sandrunner::hil {

/// The controller as a process of its own.
class ControllerProcess {
 public:
  /// Starts it; what it prints goes into the file `log`. Throws InputError.
  ControllerProcess(const std::vector<std::string>& command, const std::string& log);
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

}  // namespace sandrunner::hil
