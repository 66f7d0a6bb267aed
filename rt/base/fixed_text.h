// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <string>

namespace sandrunner {

/// A number with this many digits behind the point, for people: what rounds to zero has no sign.
inline std::string fixed_text(double value, int digits) {
  std::string text = fmt::format("{:.{}f}", value, digits);
  if (text.starts_with('-') && text.find_first_of("123456789in") == std::string::npos) {
    text.erase(0, 1);
  }
  return text;
}

}  // namespace sandrunner
