// SPDX-License-Identifier: BSD-3-Clause
// One run of the list: the bench plays, the controller runs as a process of its own, both are
// judged.
#pragma once

#include <string>
#include <vector>

#include "tools/hil/fault_runs.h"

namespace sandrunner::hil {

struct RunPlace {
  std::string controller = "sandrunner";
  std::string hardware_dir = ".";  ///< where mit.toml, damiao.toml and moteus.toml lie
  std::string imu_link = "/tmp/imu";
  std::string out_dir;  ///< gets a folder for each run: log.txt, bench.json, black boxes
  std::string terrain = "dry-sand";
  std::string command = "1,0,0";
  double walk_s = 10.0;                  ///< of the runs that walk to their end
  double speed_mps = 0.0;                ///< expected in their second half, to 5 %; 0: not judged
  std::vector<std::string> assignments;  ///< of --set, for both
};

/// What came of it: a line for each thing that is not as the list says, none if all is.
struct RunVerdict {
  std::vector<std::string> wrong;
  std::string report;  ///< of the bench, for a person
};

/// Throws InputError where the run cannot be begun.
RunVerdict run_controller(const FaultRun& run, const RunPlace& place);

}  // namespace sandrunner::hil
