// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/run_robot.h"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "rt/base/standard_error.h"

namespace sandrunner {

RunRobot::RunRobot(const Options& options, const ProcessConfig& config) {
  if (options.hardware_path.empty()) {
    auto simulator = std::make_unique<sim::Simulator>(config.robot, config.simulator);
    if (!options.start_walking) simulator->reset_lying();
    simulator_ = simulator.get();
    io_ = std::move(simulator);
    return;
  }
  driver_ = config.driver;
  io_ = driver_->connect();
  std::vector<std::string> lines = driver_->warnings();
  if (config.controller.gate.hanging) {
    lines.emplace_back(
        "tilt, free_fall, joint_misplaced and a body that moves while its encoders stand still are "
        "not judged, and Walk is refused: hardware.hanging is true");
  }
  for (const std::string& line : lines) to_standard_error(fmt::format("sandrunner: {}\n", line));
}

std::string RunRobot::report() const { return driver_ ? driver_->report(*io_) : std::string(); }

}  // namespace sandrunner
