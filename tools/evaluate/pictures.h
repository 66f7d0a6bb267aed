// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "tools/evaluate/metrics.h"

namespace sandrunner::evaluate {

/// Draws straight_speed.png and straight_cost.png, or grid.png, into the folder; nothing for the
/// other parts. Throws InputError.
void draw_part(const PartResults& results, const std::vector<std::string>& policies,
               const std::string& dir);

}  // namespace sandrunner::evaluate
