// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "rt/core/command_shaping.h"
#include "tools/evaluate/metrics.h"

namespace sandrunner::evaluate {

/// Draws the part "commands": for each policy and plane, which share of the robots survived a
/// command on the ground that is worst for it, with the policy's envelope. Throws InputError.
void draw_commands(const PartResults& results, const std::vector<std::string>& policies,
                   const std::vector<CommandEnvelope>& envelopes, const std::string& path);

}  // namespace sandrunner::evaluate
