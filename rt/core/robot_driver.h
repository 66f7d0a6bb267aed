// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rt/core/controller.h"
#include "rt/core/robot_io.h"

namespace sandrunner {

class RobotDriver;

/// What a user requests from `sandrunner check`.
struct CheckTask {
  std::string path;                  ///< of the hardware file
  JointArray<double> nominal_rad{};  ///< posture in which directions are explained
  bool plan = false;                 ///< the load of the buses alone; opens nothing
  bool move = false;                 ///< a person turns each joint by hand
  bool nudge = false;                ///< each drive pushes its joint, the robot hanging
  /// The pose in which the robot is held, from which the zeros are computed and written to `path`.
  std::optional<JointArray<double>> zero_pose_rad;
  /// Reads the whole configuration with this text in place of the file, to validate new zeros.
  std::function<std::shared_ptr<RobotDriver>(const std::string& text)> read;
};

/// How a program gets to a real robot: a driver with its settings. Ordinary threads. Programs know
/// no more of a driver than this: drivers/README.md says how to add one.
class RobotDriver {
 public:
  virtual ~RobotDriver() = default;
  /// Adapts the gate's thresholds to what this robot reports, and how often.
  virtual void fit_gate(GateConfig& gate) const noexcept = 0;
  /// Adapts the driver to the controller, whose own settings are read after fit_gate(). Throws
  /// InputError.
  virtual void fit_to(const ControllerConfig& controller) = 0;
  /// Examines the robot before it carries itself. Prints the report to standard output, and
  /// requests to the user to standard error. Returns the exit code: 0, or kExitFailed if something
  /// is wrong. Throws InputError: a task that this robot does not have, no robot.
  virtual int check(const CheckTask& task) const = 0;
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
