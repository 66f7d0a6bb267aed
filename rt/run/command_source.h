// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

}  // namespace sandrunner
