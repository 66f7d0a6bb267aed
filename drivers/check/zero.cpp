// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/check/zero.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rt/base/errors.h"
#include "rt/base/toml_depth.h"

namespace sandrunner {
namespace {

/// Bytes [begin, end) of the text become `by`.
struct Change {
  std::size_t begin = 0, end = 0;
  std::string by;
};

/// Offset of a place that toml++ gives in lines and characters, both from 1.
std::size_t offset_of(const std::string& text, const toml::source_position& place) {
  std::size_t at = 0;
  for (toml::source_index line = 1; line < place.line; ++line) at = text.find('\n', at) + 1;
  for (toml::source_index column = 1; column < place.column && at < text.size(); ++column) {
    ++at;
    while (at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0) == 0x80) ++at;
  }
  return at;
}

toml::table parsed(const std::string& text, const std::string& name) {
  if (find_too_deep(text).line != 0) throw InputError(fmt::format("{}: nested too deep", name));
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    throw InputError(fmt::format("{}:{}: {}", name, error.source().begin.line,
                                 std::string(error.description())));
  }
}

const toml::table* drive_of(const toml::table& file, const std::string& joint) {
  const toml::array* const drives = file.at_path("hardware.drive").as_array();
  if (drives == nullptr) return nullptr;
  for (const toml::node& node : *drives) {
    const toml::table* const drive = node.as_table();
    if (drive != nullptr && (*drive)["joint"].value_or(std::string()) == joint) return drive;
  }
  return nullptr;
}

Change change_of(const std::string& text, const toml::table& drive, double zero_rad) {
  const std::string number = fmt::format("{:.4f}", zero_rad == 0.0 ? 0.0 : zero_rad);
  if (const toml::node* const old = drive.get("zero_rad")) {
    return {offset_of(text, old->source().begin), offset_of(text, old->source().end), number};
  }
  const std::size_t joint_end = offset_of(text, drive.get("joint")->source().end);
  if (drive.is_inline()) return {joint_end, joint_end, ", zero_rad = " + number};
  std::size_t line_end = std::min(text.find('\n', joint_end), text.size());
  const bool crlf = line_end > 0 && line_end < text.size() && text[line_end - 1] == '\r';
  if (crlf) --line_end;
  return {line_end, line_end, (crlf ? "\r\nzero_rad = " : "\nzero_rad = ") + number};
}

}  // namespace

JointArray<double> zeros_of(const JointTrace& trace, const JointArray<double>& pose_rad,
                            const HardwareConfig& config, const RobotDescription& robot) {
  if (trace.empty()) throw InputError("no position was measured");
  JointArray<double> zeros;
  for (int j = 0; j < kNumJoints; ++j) {
    double sum_rad = 0.0, least_rad = trace.front()[j], most_rad = trace.front()[j];
    for (const JointArray<double>& positions : trace) {
      sum_rad += positions[j];
      least_rad = std::min(least_rad, positions[j]);
      most_rad = std::max(most_rad, positions[j]);
    }
    const std::string& name = robot.joint_names[j];
    if (!(most_rad - least_rad <= kHeldStill_rad)) {
      throw InputError(fmt::format("{} moved by {:.3f} rad while it was to be still", name,
                                   most_rad - least_rad));
    }
    zeros[j] =
        config.drives[j].zero_rad + pose_rad[j] - sum_rad / static_cast<double>(trace.size());
    if (std::fabs(zeros[j]) > 2.0 * std::numbers::pi) {
      throw InputError(fmt::format(
          "{}: its zero would be at {:.3f} rad, more than a turn away: sign or gear of the drive, "
          "or the pose",
          name, zeros[j]));
    }
  }
  return zeros;
}

std::string with_zeros(const std::string& text, const std::string& name,
                       const JointArray<double>& zero_rad, const RobotDescription& robot) {
  const toml::table file = parsed(text, name);
  std::vector<Change> changes;
  for (int j = 0; j < kNumJoints; ++j) {
    const toml::table* const drive = drive_of(file, robot.joint_names[j]);
    if (drive == nullptr) {
      throw InputError(
          fmt::format("{}: found no hardware.drive of joint {}", name, robot.joint_names[j]));
    }
    changes.push_back(change_of(text, *drive, zero_rad[j]));
  }
  // From the end: what comes before keeps its place.
  std::sort(changes.begin(), changes.end(),
            [](const Change& a, const Change& b) { return a.begin > b.begin; });
  std::string changed = text;
  for (const Change& change : changes) {
    changed.replace(change.begin, change.end - change.begin, change.by);
  }
  return changed;
}

}  // namespace sandrunner
