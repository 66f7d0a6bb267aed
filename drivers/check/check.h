// SPDX-License-Identifier: BSD-3-Clause
// sandrunner check: examines a robot's buses, drives and IMU before it carries itself.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "drivers/robot/hardware_config.h"

namespace sandrunner {

/// The inputs of a check.
struct CheckTask {
  std::string path;  ///< of the hardware file
  HardwareConfig config;
  RobotDescription robot;
  GateConfig gate;
  JointArray<double> nominal_rad{};  ///< posture in which directions are explained
  bool move = false;                 ///< a person turns each joint by hand
  bool nudge = false;                ///< each drive pushes its joint, the robot hanging
  /// The pose in which the robot is held, from which the zeros are computed and written to `path`.
  std::optional<JointArray<double>> zero_pose_rad;
  /// Reads the whole configuration with this text in place of the file, to validate new zeros.
  std::function<HardwareConfig(const std::string& text)> read;
};

/// Runs the check: prints the report to standard output, and requests to the user to standard
/// error. Returns the exit code: 0, or kExitFailed if something is wrong. Throws InputError: zeros
/// that are impossible, a file that cannot be written, no answering drive, a nudge of a robot that
/// does not hang.
int run_check(const CheckTask& task);

}  // namespace sandrunner
