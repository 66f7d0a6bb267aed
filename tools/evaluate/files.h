// SPDX-License-Identifier: BSD-3-Clause
// Results as files: evaluation.json and one CSV file for each part.
#pragma once

#include <string>

#include "tools/evaluate/metrics.h"
#include "tools/evaluate/options.h"

namespace sandrunner::evaluate {

/// Everything: settings, the robot's name, and every figure of every group with its interval;
/// with the part "commands", the policies' envelopes.
std::string results_json(const Results& results, const std::string& robot, const Options& options);

/// One row a group and policy, columns `key`, `key_low`, `key_high`, `key_n`; empty where there is
/// none.
std::string part_csv(const PartResults& results, const std::vector<std::string>& policies);

}  // namespace sandrunner::evaluate
