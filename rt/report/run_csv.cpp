// SPDX-License-Identifier: BSD-3-Clause
#include "rt/report/run_csv.h"

#include <fmt/format.h>

#include <cstring>
#include <string_view>

#include "rt/base/output_files.h"
#include "rt/core/mode_machine.h"

namespace sandrunner {
namespace {

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) c == separator ? parts.emplace_back() : parts.back() += c;
  return parts;
}

void expand(const std::string& pattern, const RobotDescription& robot,
            std::vector<std::string>& names) {
  const std::size_t open = pattern.find('{'), close = pattern.find('}');
  if (open == std::string::npos) {
    names.push_back(pattern);
    return;
  }
  const std::string inside = pattern.substr(open + 1, close - open - 1);
  std::vector<std::string> words = split(inside, ',');
  if (inside == "leg") words.assign(robot.leg_names.begin(), robot.leg_names.end());
  if (inside == "joint") words.assign(robot.joint_names.begin(), robot.joint_names.end());
  for (const std::string& word : words) {
    expand(pattern.substr(0, open) + word + pattern.substr(close + 1), robot, names);
  }
}

template <typename T>
T number_at(const RunRow& row, std::size_t offset) {
  T number;
  std::memcpy(&number, reinterpret_cast<const std::byte*>(&row) + offset, sizeof number);
  return number;
}

void append(std::string& text, const RunRow& row, const RowField& field) {
  const std::string_view type = field.type;
  for (std::size_t i = 0; i < field.count; ++i) {
    const std::size_t at = field.offset + i * field.width();
    if (field.offset == offsetof(RunRow, mode)) {
      text += mode_name(mode_of(row));
    } else if (type == "f64") {
      fmt::format_to(std::back_inserter(text), "{:.9g}", number_at<double>(row, at));
    } else if (type == "f32") {
      fmt::format_to(std::back_inserter(text), "{}", number_at<float>(row, at));
    } else {
      fmt::format_to(std::back_inserter(text), "{}", number_at<std::uint32_t>(row, at));
    }
    text += ',';
  }
}

}  // namespace

std::vector<std::string> columns_of(const std::string& patterns, const RobotDescription& robot) {
  std::vector<std::string> names;
  for (const std::string& pattern : split(patterns, '|')) expand(pattern, robot, names);
  return names;
}

std::vector<std::string> csv_columns(const RobotDescription& robot) {
  std::vector<std::string> names;
  for (const RowField& field : kRowFields) {
    for (std::string& name : columns_of(field.columns, robot)) names.push_back(std::move(name));
  }
  return names;
}

void write_csv(const RunRecord& record, const std::string& path) {
  constexpr std::size_t kPiece = std::size_t{1} << 20;  // all of a long run are 130 MB
  WholeFile file(path);
  std::string text = fmt::format("{}\n", fmt::join(csv_columns(record.scene.robot), ","));
  for (const RunRow& row : record.rows) {
    for (const RowField& field : kRowFields) append(text, row, field);
    text.back() = '\n';
    if (text.size() < kPiece) continue;
    file.write(text);
    text.clear();
  }
  file.write(text);
  file.keep();
}

}  // namespace sandrunner
