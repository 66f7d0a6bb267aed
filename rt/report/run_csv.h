// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "rt/report/run_record.h"

namespace sandrunner {

/// Names of the columns, with units, in their order.
std::vector<std::string> csv_columns(const RunScene& scene);

/// Writes the samples, one row each, under a header of `csv_columns`. Estimates that do not exist
/// are "nan". The file is whole or not there; InputError if it cannot be written.
void write_csv(const RunRecord& record, const std::string& path);

}  // namespace sandrunner
