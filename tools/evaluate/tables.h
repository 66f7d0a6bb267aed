// SPDX-License-Identifier: BSD-3-Clause
// Results as text for a terminal.
#pragma once

#include <string>

#include "tools/evaluate/metrics.h"

namespace sandrunner::evaluate {

/// The tables of one part, policies one below the other.
std::string tables(const PartResults& results, const std::vector<std::string>& policies);

}  // namespace sandrunner::evaluate
