// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "rt/report/run_record.h"

namespace sandrunner {

/// Names of the columns, with units, in their order: those of all fields of a row.
std::vector<std::string> csv_columns(const RobotDescription& robot);

/// The columns that RowField::columns means: patterns separated by '|'; in a pattern, {leg} and
/// {joint} stand for the robot's names, {a,b} for a, then b; the rightmost changes fastest.
std::vector<std::string> columns_of(const std::string& patterns, const RobotDescription& robot);

/// Writes the rows under a header of `csv_columns`. What does not exist is "nan". The file is whole
/// or not there; InputError if it cannot be written.
void write_csv(const RunRecord& record, const std::string& path);

}  // namespace sandrunner
