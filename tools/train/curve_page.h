// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "policy/policy_file.h"
#include "sim/robot/robot_model.h"
#include "tools/train/progress.h"

namespace sandrunner::train {

/// curve.html, a page that opens from disk (rt/telemetry/view): the learning curve, and beneath it
/// a run of the present policy, a few seconds at `speed_mps` forward on dry sand. The run is that
/// of `sandrunner --start walk` with this robot and policy; nothing of the training depends on it.
/// At most 2 MB. For a thread in which denormal numbers are zero. `transitions`: after which the
/// policy was taken.
std::string curve_page(const Progress& progress, const PolicyFile& policy, double transitions,
                       const sim::Robot& robot, double speed_mps);

}  // namespace sandrunner::train
