// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>

#include "rt/report/run_record.h"

namespace sandrunner {

/// The fields of a row that a page gets.
std::span<const RowField> page_fields();

/// What a page is told once, before any frame, as JSON: the robot (its URDF with shapes, which also
/// has its limits), names, ground, layout of frames and footprints, names of modes and faults.
/// `note`: a line for whoever looks at the page; may be empty. All
/// characters that HTML could take for its own are escaped.
std::string view_hello(const RunScene& scene, const std::string& note);

}  // namespace sandrunner
