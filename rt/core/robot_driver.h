// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "rt/core/controller.h"
#include "rt/core/robot_io.h"

namespace sandrunner {

/// How a program gets to a real robot: a driver with its settings. Ordinary threads. Programs know
/// no more of a driver than this: drivers/README.md says how to add one.
class RobotDriver {
 public:
  virtual ~RobotDriver() = default;
  /// Starts what needs a process of its own, before the program has a second thread. Throws
  /// InputError.
  virtual void fork_processes() {}
  /// Finds the robot; nothing moves. Throws InputError, one line.
  virtual std::unique_ptr<RobotIo> connect() = 0;
  /// A line for each thing that guards this robot less than it could.
  virtual std::vector<std::string> warnings() const { return {}; }
  /// What a robot that stands would be sent, for a person; opens nothing.
  virtual std::string dry_run(const StandConfig& stand) const = 0;
  /// What the driver counted during a run, for a person. `robot`: that of connect().
  virtual std::string report(const RobotIo& robot) const = 0;
};

}  // namespace sandrunner
