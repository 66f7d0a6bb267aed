// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>

namespace sandrunner {

/// A time from now.
class Deadline {
 public:
  explicit Deadline(int time_ms)
      : end_(std::chrono::steady_clock::now() + std::chrono::milliseconds(time_ms)) {}

  /// Rounded up; not above 0: it is over.
  int left_ms() const {
    const auto left = end_ - std::chrono::steady_clock::now();
    return static_cast<int>(std::chrono::ceil<std::chrono::milliseconds>(left).count());
  }

 private:
  std::chrono::steady_clock::time_point end_;
};

}  // namespace sandrunner
