// SPDX-License-Identifier: BSD-3-Clause
// sandrunner check: examines a robot's buses, drives and IMU before it carries itself.
#pragma once

#include <functional>
#include <string>

#include "drivers/robot/hardware_config.h"
#include "rt/core/robot_driver.h"

namespace sandrunner {

/// The inputs of a check.
struct CanCheck {
  const CheckTask& task;
  const HardwareConfig& config;
  const RobotDescription& robot;
  const GateConfig& gate;
  /// As `task.read`.
  std::function<HardwareConfig(const std::string& text)> read;
};

/// Runs the check: prints the report to standard output, and requests to the user to standard
/// error. Returns the exit code: 0, or kExitFailed if something is wrong. Throws InputError: zeros
/// that are impossible, a file that cannot be written, no answering drive, a nudge of a robot that
/// does not hang.
int run_check(const CanCheck& check);

}  // namespace sandrunner
