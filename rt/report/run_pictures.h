// SPDX-License-Identifier: BSD-3-Clause
// The pictures of a run.
#pragma once

#include <string>

#include "rt/report/run_record.h"

namespace sandrunner {

/// Speed, yaw rate, torques, sinkage and estimate against truth over time: the whole run and its
/// last second of walking, to a PNG. InputError if the file cannot be written.
void draw_run_plot(const RunRecord& record, const std::string& png_path);

/// Ten side views spread over the walk (over the run, if the robot never walked): ground,
/// footprints so far and the robot, seen from its right; to a PNG. InputError if the file cannot be
/// written.
void draw_run_strip(const RunRecord& record, const std::string& png_path);

}  // namespace sandrunner
