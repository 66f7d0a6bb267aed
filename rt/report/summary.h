// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "rt/run/command_source.h"
#include "rt/run/options.h"
#include "rt/run/run.h"

namespace sandrunner {

/// The result as a table for a person.
std::string summary_table(const RunResult& result, const std::string& command);

/// The result as summary.json (rt/README.md lists the keys).
std::string summary_json(const RunResult& result, const Options& options,
                         const std::string& command, const std::string& policy_name);

}  // namespace sandrunner
