// SPDX-License-Identifier: BSD-3-Clause
// sandrunner check of a Unitree robot: listens, asks which program controls it, and sends it no
// command.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/unitree/bring_up.h"
#include "drivers/unitree/unitree_config.h"

namespace sandrunner {

/// What the check found.
struct UnitreeFindings {
  unitree::StateFigures states;
  bool wrong_state_type = false, wrong_command_type = false;
  bool commands_are_read = false;
  std::uint64_t foreign_commands = 0;
  /// Which of the robot's own programs controls it; empty: none; no value: the service that says
  /// so does not answer.
  std::optional<std::string> mode;
};

/// A line for each thing that is wrong.
std::vector<std::string> unitree_check_problems(const UnitreeConfig& config,
                                                const unitree::RobotFigures& robot,
                                                const UnitreeFindings& findings);
/// The joints against their stops, and what else a state says.
std::string unitree_state_table(const UnitreeConfig& config, const unitree::RobotFigures& robot,
                                const unitree::RobotState& state);
/// The whole report.
std::string unitree_check_report(const UnitreeConfig& config, const unitree::RobotFigures& robot,
                                 const UnitreeFindings& findings);

/// Runs the check: prints the report to standard output, and on a terminal the joints as they are,
/// until Enter. Returns the exit code: 0, or kExitFailed if something is wrong. Throws InputError.
int run_unitree_check(const UnitreeConfig& config, const unitree::RobotFigures& robot);

}  // namespace sandrunner
