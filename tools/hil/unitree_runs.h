// SPDX-License-Identifier: BSD-3-Clause
// What the controller of a Unitree robot is to do when something goes wrong: one list, which the
// bench runs and from which the table of drivers/unitree/README.md is made.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace sandrunner::hil {

/// The joints that are named with a fault.
enum class NamedJoints { kNone, kOne, kAll };

/// One run of the controller against the emulated robot.
struct UnitreeRun {
  const char* name;
  const char* what;   ///< goes wrong
  const char* fault;  ///< script of the bench; {} is its joint; "": nothing goes wrong
  const char* bit;    ///< the fault that latches; "": none
  NamedJoints joints;
  const char* says;  ///< part of what the controller prints; "": nothing particular
  const char* then;  ///< what becomes of the robot
  int exit_code;     ///< of the controller; -1: it is killed, or never ends
  /// From the fault until no motor has a stiffness or a torque of its own; 0: not asked for.
  double damped_within_s;
  const char* first = "";    ///< fault of the bench that is made at the start
  const char* setting = "";  ///< of the controller alone
};
std::span<const UnitreeRun> unitree_runs();

/// The table for drivers/unitree/README.md.
std::string unitree_run_markdown();

struct UnitreePlace {
  std::string controller = "sandrunner";
  std::string hardware;  ///< file of kind "unitree"
  std::string out_dir;   ///< gets a folder for each run
  std::string terrain = "dry-sand";
  double speed_mps = 1.0;                ///< commanded, forward
  double walk_s = 20.0;                  ///< of the run in which nothing goes wrong; of others 1 s
  std::vector<std::string> assignments;  ///< of --set, for both
};

/// What came of a run: a line for each thing that is not as the list says.
struct UnitreeVerdict {
  std::vector<std::string> wrong;
  std::string report;    ///< of the bench
  bool held_up = false;  ///< this computer stopped a process for too long: the run says nothing
};

/// Throws InputError where the run cannot be begun. `domain`: of DDS, one of its own for each run.
UnitreeVerdict run_unitree(const UnitreeRun& run, const UnitreePlace& place, int domain);

}  // namespace sandrunner::hil
