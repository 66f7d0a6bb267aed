// SPDX-License-Identifier: BSD-3-Clause
// One run of a list: the bench plays, the controller runs as a process of its own, both are judged.
#pragma once

#include <string>
#include <vector>

#include "tools/hil/fault_runs.h"

namespace sandrunner::hil {

struct RunPlace {
  std::string controller = "sandrunner";
  std::string hardware = ".";  ///< the file, or the folder where the runs' own example files lie
  std::string imu_link = "/tmp/imu";
  std::string out_dir;  ///< gets a folder for each run: log.txt, bench.json, black boxes
  std::string terrain = "dry-sand";
  std::string command = "1,0,0";
  double walk_s = 10.0;                  ///< of the runs that walk to their end
  double speed_mps = 0.0;                ///< expected in their second half, to 5 %; 0: not judged
  std::vector<std::string> assignments;  ///< of --set, for both
};

/// What came of a run: a line for each thing that is not as the list says.
struct RunVerdict {
  std::vector<std::string> wrong;
  std::string report;    ///< of the bench, for a person
  bool held_up = false;  ///< this computer stopped a process for too long: the run says nothing
};

/// A run of can_fault_runs(). Throws InputError where the run cannot be begun.
RunVerdict run_can_fault(const FaultRun& run, const RunPlace& place);

/// A run of unitree_fault_runs(), over loopback. Walks for 1 s where something goes wrong; else at
/// the speed of the same walk in process. `domain`: of DDS, one of its own for each run.
RunVerdict run_unitree_fault(const FaultRun& run, const RunPlace& place, int domain);

}  // namespace sandrunner::hil
