// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "rt/report/run_record.h"

namespace sandrunner {

/// Writes run.csv and run.html into a folder that exists; returns their paths, separated by ", ".
/// Throws InputError.
std::string write_run_files(const RunRecord& record, const std::string& folder);

}  // namespace sandrunner
