// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/evaluate/study.h"

namespace sandrunner::evaluate {

struct Options {
  std::string policy_path, against_path, robot = "raibo", out_dir;
  StudySettings study;
  int threads = 1;
  std::vector<PartRow> parts;  ///< of kParts, in its order
  bool torque_speed_line = true;
};

/// Reads the command line; nothing if it asked for help or the version, which are then printed.
/// Throws InputError.
std::optional<Options> parse_options(int argc, const char* const* argv);

}  // namespace sandrunner::evaluate
