// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "rt/core/robot_driver.h"
#include "rt/run/options.h"
#include "rt/run/process_config.h"
#include "sim/simulator.h"

namespace sandrunner {

/// The robot of a run: the real one of `--hardware`, or the simulator in its place.
class RunRobot {
 public:
  /// Finds the real robot and says on standard error what guards it less than it could. Throws
  /// InputError.
  RunRobot(const Options& options, const ProcessConfig& config);

  RobotIo& io() noexcept { return *io_; }
  /// Null: it is a real robot.
  sim::Simulator* simulator() noexcept { return simulator_; }
  /// What the driver of a real robot counted; else empty.
  std::string report() const;

 private:
  std::shared_ptr<RobotDriver> driver_;  // null: simulated
  std::unique_ptr<RobotIo> io_;
  sim::Simulator* simulator_ = nullptr;  // is io_
};

}  // namespace sandrunner
