// SPDX-License-Identifier: BSD-3-Clause
// Text in files, and messages about files: one line each, whatever the file holds.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "rt/base/errors.h"

namespace sandrunner {

/// Throws InputError "'<path>': <message>".
template <typename... Arguments>
[[noreturn]] void fail_file(const std::string& path, fmt::format_string<Arguments...> message,
                            Arguments&&... arguments) {
  throw InputError(
      fmt::format("'{}': {}", path, fmt::format(message, std::forward<Arguments>(arguments)...)));
}

/// `text` from a file as one line: at most `limit` bytes, control characters as '?'.
inline std::string printable(std::string_view text, std::size_t limit = 80) {
  std::string line(text.substr(0, limit));
  replace_controls(line, '?');
  return text.size() > limit ? line + "..." : line;
}

/// The values with `separator` between them; numbers as the shortest text that reads back as the
/// same number. (fmt::join draws false warnings from g++ 12.)
template <typename Range>
std::string joined(const Range& values, std::string_view separator) {
  std::string text;
  for (const auto& value : values) {
    if (!text.empty()) text += separator;
    text += fmt::format("{}", value);
  }
  return text;
}

}  // namespace sandrunner
