// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "rt/report/run_record.h"
#include "rt/run/process_config.h"

namespace sandrunner {

/// What figures and pictures of a run must know of its robot and, if it is simulated, of its
/// ground. `policy`: its name, may be empty.
RunScene scene_of(const ProcessConfig& config, const std::string& policy);

}  // namespace sandrunner
