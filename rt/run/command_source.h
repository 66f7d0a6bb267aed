// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "rt/core/messages.h"

namespace sandrunner {

/// The velocity command over the time in Walk: a constant, or the rows of a CSV file, linear
/// between them and held before the first and after the last.
class CommandSource {
 public:
  /// `text`: "vx,vy,wz" (m/s, m/s, rad/s), or a CSV file with the header t_s,vx,vy,wz. Throws
  /// InputError, one line.
  explicit CommandSource(const std::string& text);
  explicit CommandSource(const VelocityCommand& constant) : rows_{{0.0, constant}} {}

  VelocityCommand at(double time_s) const noexcept;
  /// As it was given: the numbers, or the file's name.
  const std::string& text() const noexcept { return text_; }

 private:
  struct Row {
    double t_s;
    VelocityCommand command;
  };
  std::string text_;
  std::vector<Row> rows_;  // at least one, ascending in time
};

inline VelocityCommand CommandSource::at(double time_s) const noexcept {
  const auto next = std::upper_bound(rows_.begin(), rows_.end(), time_s,
                                     [](double t, const Row& row) { return t < row.t_s; });
  if (next == rows_.begin()) return rows_.front().command;
  const Row& a = *(next - 1);
  if (next == rows_.end()) return a.command;
  const Row& b = *next;
  const double share = (time_s - a.t_s) / (b.t_s - a.t_s);
  const auto between = [&](double from, double to) { return from + share * (to - from); };
  return {between(a.command.vx_mps, b.command.vx_mps), between(a.command.vy_mps, b.command.vy_mps),
          between(a.command.wz_radps, b.command.wz_radps)};
}

}  // namespace sandrunner
