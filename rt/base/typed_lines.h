// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

namespace sandrunner {

/// Lines typed on standard input, read without waiting.
class Lines {
 public:
  /// The next line, without its end, if there is one.
  std::optional<std::string> next();
  /// No more will come.
  bool ended() const noexcept { return ended_ && typed_.empty(); }

 private:
  std::string typed_;
  bool ended_ = false;
};

}  // namespace sandrunner
