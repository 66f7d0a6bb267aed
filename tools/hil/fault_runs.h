// SPDX-License-Identifier: BSD-3-Clause
// What a controller is to do when something goes wrong: two lists, of robots on CAN buses and of
// Unitree's. The bench runs them, and the tables of drivers/README.md and
// drivers/unitree/README.md are made from them.
#pragma once

#include <set>
#include <span>
#include <string>
#include <vector>

#include "rt/core/robot_description.h"

namespace sandrunner::hil {

/// As `FaultRun::joints`: all of the robot; the one that the script calls {}.
inline constexpr const char *kAllJoints = "all", *kThatJoint = "that one";

/// As `FaultRun::exit_code`: a signal ends the controller; it may end in any way, or never.
inline constexpr int kKilled = -1, kNoMatter = -2;

/// One run of the controller against the bench.
struct FaultRun {
  const char* name;
  const char* what;    ///< goes wrong
  const char* fault;   ///< of the bench (fault_script.h), with ; between; {}: a joint
  const char* bit;     ///< the fault that latches; "": none, `says` then tells
  const char* joints;  ///< that are named with it, with blanks between
  const char* says;    ///< part of what the controller prints; "": nothing particular
  const char* then;    ///< what becomes of the robot
  int exit_code;       ///< of the controller, or kKilled, kNoMatter
  /// From the last fault until no reachable drive has a stiffness of its own, and until no drive at
  /// all has; 0: not judged.
  double damped_within_s;
  double passive_within_s = 0.0;
  const char* hardware = "";  ///< example file: "damiao", "mit" or "moteus"; "": that of RunPlace
  const char* setting = "";   ///< of the controller alone

  /// Its faults, and the names of its joints.
  std::vector<std::string> faults_of(const RobotDescription& robot) const;
  std::set<std::string> joints_of(const RobotDescription& robot) const;
  bool nothing_goes_wrong() const noexcept { return *fault == '\0' && *setting == '\0'; }
};
std::span<const FaultRun> can_fault_runs();
std::span<const FaultRun> unitree_fault_runs();

/// The table for a README.
std::string fault_run_markdown(std::span<const FaultRun> runs);

}  // namespace sandrunner::hil
