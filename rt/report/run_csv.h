// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "rt/report/run_record.h"

namespace sandrunner {

/// Names of the columns, with units, in their order.
std::vector<std::string> csv_columns(const RunScene& scene);

/// Writes the samples, one row each, under a header of `csv_columns`. Estimates that do not exist
/// are "nan". Writes a file beside `path` and renames it, so that no half file is left; InputError
/// if it cannot.
void write_csv(const RunRecord& record, const std::string& path);

}  // namespace sandrunner
