// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "tools/study/experiments/runs.h"

namespace sandrunner::study {

/// The numbers of a file of `sandrunner-bench contact --json` that claims need: "ratio", the time
/// of DRFT in space over ours; "spread_cone", "spread_drft" and "spread_planar", the range of the
/// quartiles of the final depths over their median; "processor" and the texts that they are from.
/// Throws InputError.
Json read_contact_bench(const std::string& path);

}  // namespace sandrunner::study
