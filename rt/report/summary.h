// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "rt/report/run_result.h"

namespace sandrunner {

/// The result as a table for a person.
std::string summary_table(const RunResult& result, const RunInfo& info);

/// The result as summary.json (rt/README.md lists the keys).
std::string summary_json(const RunResult& result, const RunInfo& info);

}  // namespace sandrunner
