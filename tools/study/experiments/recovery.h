// SPDX-License-Identifier: BSD-3-Clause
// How a run goes on after one of its feet has stood on loose sand.
#pragma once

#include <optional>

#include "tools/study/experiments/lab.h"

namespace sandrunner::study {

struct Recovery {
  double time_s = 0.0;       ///< until the speed is back for half a second; nan: never in the run
  double swing_ratio = 0.0;  ///< height of the other front foot's next swing over its usual one
};

/// That of a run in which the left front foot stood on a patch; nothing if it never did. The speed
/// is back when its mean over the next 0.3 s is at least 90 % of that of the second before the
/// stance. The usual swings are those that ended in that second.
std::optional<Recovery> recovery_of(const Ran& run);

}  // namespace sandrunner::study
