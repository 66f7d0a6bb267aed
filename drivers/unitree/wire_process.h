// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <string>

#include "drivers/unitree/bring_up.h"
#include "drivers/unitree/unitree_config.h"
#include "drivers/unitree/wire_memory.h"
#include "rt/base/guard_process.h"

namespace sandrunner::unitree {

/// The process that owns the wire to a robot: it alone is in the robot's DDS domain. It sends the
/// newest command 500 times a second, and what CommandWatch says where the controller falls silent,
/// ends or is killed. So a controller that does not run any more leaves a damped robot, whatever
/// the robot itself does when commands stop. It is the child of a second process, the guard, which
/// watches it, kills it where it hangs, and damps the robot where it was killed or failed. The two
/// have names and a session of their own: `pkill -9 sandrunner` ends neither. Example:
/// wire_process_test.cpp.
class WireProcess {
 public:
  /// Forks them; they do nothing yet. To be called while this process has one thread. Throws
  /// InputError.
  WireProcess(const UnitreeConfig& config, const RobotFigures& robot);
  /// Ends them; waits for that, or kills the wire after a second. A guard that damps goes on alone.
  ~WireProcess();
  WireProcess(const WireProcess&) = delete;
  WireProcess& operator=(const WireProcess&) = delete;

  /// Has it find the robot and prepare it (bring_up); seconds. Throws InputError.
  void connect();
  WireMemory& memory() noexcept { return *memory_; }
  const WireMemory& memory() const noexcept { return *memory_; }
  /// Whether they still run.
  bool runs() const noexcept;

 private:
  Shared<WireMemory> memory_;
  pid_t pid_ = 0;     // of the guard
  int process_ = -1;  // pidfd: readable once it has ended
};

}  // namespace sandrunner::unitree
