// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/command_source.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "rt/base/errors.h"
#include "rt/base/input_file.h"

namespace sandrunner {
namespace {

constexpr std::size_t kMostBytes = std::size_t{16} << 20;  // an hour of 100 rows a second
constexpr double kMaxSpeed = 20.0;  // m/s, rad/s: beyond any robot, so surely a mistake

// Comma-separated finite numbers; false if the text is anything else.
bool parse_numbers(std::string_view text, std::vector<double>& numbers) {
  numbers.clear();
  while (true) {
    const auto comma = text.find(',');
    std::string_view field = text.substr(0, comma);
    while (!field.empty() && (field.front() == ' ' || field.front() == '\t'))
      field.remove_prefix(1);
    while (!field.empty() &&
           (field.back() == ' ' || field.back() == '\t' || field.back() == '\r')) {
      field.remove_suffix(1);
    }
    if (field.starts_with('+') && !field.starts_with("+-")) field.remove_prefix(1);
    double value = 0.0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error != std::errc() || end != field.data() + field.size() || !std::isfinite(value))
      return false;
    numbers.push_back(value);
    if (comma == std::string_view::npos) return true;
    text.remove_prefix(comma + 1);
  }
}

VelocityCommand checked(double vx, double vy, double wz, const std::string& where) {
  for (const double v : {vx, vy, wz}) {
    if (std::fabs(v) > kMaxSpeed) {
      throw InputError(
          fmt::format("{}: {}, expected at most {} m/s or rad/s", where, v, kMaxSpeed));
    }
  }
  return {vx, vy, wz};
}

}  // namespace

CommandSource::CommandSource(const std::string& text) : text_(text) {
  std::vector<double> numbers;
  if (parse_numbers(text, numbers)) {
    if (numbers.size() != 3) {
      throw InputError(fmt::format("--command: '{}' has {} numbers, expected 3: vx,vy,wz", text,
                                   numbers.size()));
    }
    rows_.push_back({0.0, checked(numbers[0], numbers[1], numbers[2], "--command")});
    return;
  }
  std::error_code unreadable;  // a wrong list of numbers may be too long for a name
  if (!std::filesystem::is_regular_file(text, unreadable)) {
    throw InputError(
        fmt::format("--command: '{}' is neither vx,vy,wz (finite numbers) nor a file", text));
  }
  std::istringstream in(read_input_file(text, "a CSV file of commands", kMostBytes));
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (number == 1) {
      if (line != "t_s,vx,vy,wz") {
        throw InputError(
            fmt::format("{}:1: header '{}', expected 't_s,vx,vy,wz'", text, line.substr(0, 60)));
      }
      continue;
    }
    if (line.empty()) continue;
    const std::string where = fmt::format("{}:{}", text, number);
    if (!parse_numbers(line, numbers) || numbers.size() != 4) {
      throw InputError(fmt::format("{}: '{}', expected four finite numbers t_s,vx,vy,wz", where,
                                   line.substr(0, 60)));
    }
    if (!rows_.empty() && numbers[0] < rows_.back().t_s) {
      throw InputError(fmt::format("{}: t_s {} after {}, expected ascending times", where,
                                   numbers[0], rows_.back().t_s));
    }
    rows_.push_back({numbers[0], checked(numbers[1], numbers[2], numbers[3], where)});
  }
  if (rows_.empty()) throw InputError(fmt::format("{}: no rows, expected at least one", text));
}

}  // namespace sandrunner
