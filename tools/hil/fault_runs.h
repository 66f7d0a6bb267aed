// SPDX-License-Identifier: BSD-3-Clause
// What the controller is to do when something goes wrong at its buses and its serial line: one
// list, which the bench runs and from which drivers/README.md's table is made.
#pragma once

#include <span>
#include <string>

namespace sandrunner::hil {

/// One run of the controller against the bench.
struct FaultRun {
  const char* name;
  const char* what;      ///< goes wrong
  const char* hardware;  ///< example file: "damiao", "mit" or "moteus"
  const char* fault;     ///< script of the bench (fault_script.h)
  const char* bit;       ///< the fault that latches; "": none, `says` then tells
  const char* joints;    ///< that are named with it, with blanks between
  const char* says;      ///< part of what the controller prints; "": nothing particular
  const char* then;      ///< what becomes of the robot
  int exit_code;         ///< of the controller; -1: it is killed
  /// From the fault until no drive that hears its host has a stiffness of its own, and until no
  /// drive at all has; 0: not asked for.
  double damped_within_s;
  double passive_within_s;
};
std::span<const FaultRun> fault_runs();

/// The table for drivers/README.md.
std::string fault_run_markdown();

}  // namespace sandrunner::hil
