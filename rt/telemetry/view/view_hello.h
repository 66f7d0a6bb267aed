// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "rt/report/run_record.h"

namespace sandrunner {

/// The kinds of rows that a live page gets, by the number in the head of a message.
enum class ViewRowKind : std::uint32_t { kFrames, kFootprints, kTiles };
inline constexpr std::array<const char*, 3> kViewRowKinds = {"frames", "footprints", "tiles"};

/// A line for the page of a robot without ground truth.
inline constexpr const char* kNoTruthNote =
    "This robot has no ground truth: everything shown is measured or estimated.";

/// The fields of a row that a page gets.
std::span<const RowField> page_fields();

/// What a page receives once, before any frame, as JSON: the robot (its URDF with shapes, which
/// also has its limits), names, ground, layout of frames and footprints, names of modes, faults and
/// requests.
/// `note`: a line for readers of the page; may be empty. All
/// characters that HTML could take for its own are escaped.
std::string view_hello(const RunScene& scene, const std::string& note);

/// The same JSON, with all characters that HTML could take for its own escaped.
std::string without_tags(std::string json);

}  // namespace sandrunner
