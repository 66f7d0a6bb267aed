// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/toml_depth.h"

#include <algorithm>

namespace sandrunner {
namespace {

static_assert(kMostKeyParts == 32 && kMostNestedValues == 32, "the messages say so");

/// The end of the string that begins with the quote at `begin`; for one that lacks its second quote
/// the end of the line, or of the text if it may span lines: toml++ gives up there.
std::size_t end_of_string(std::string_view toml, std::size_t begin) noexcept {
  const char quote = toml[begin];
  const char triple[] = {quote, quote, quote, '\0'};
  const bool long_one = toml.substr(begin, 3) == triple;
  std::size_t at = begin + (long_one ? 3 : 1);
  for (; at < toml.size(); ++at) {
    if (quote == '"' && toml[at] == '\\') {
      ++at;
    } else if (!long_one && toml[at] == '\n') {
      return at;
    } else if (long_one ? toml.substr(at, 3) == triple : toml[at] == quote) {
      at += long_one ? 3 : 1;
      // A long string may end in one or two quotes of its own.
      for (int own = 0; long_one && own < 2 && at < toml.size() && toml[at] == quote; ++own) ++at;
      return at;
    }
  }
  return toml.size();
}

}  // namespace

TomlDepth find_too_deep(std::string_view toml) noexcept {
  // Outside of strings and comments a dot joins parts of a key, or is the one of a number.
  std::size_t line = 1, dots = 0, nested = 0;
  for (std::size_t at = 0; at < toml.size();) {
    const char c = toml[at];
    if (c == '"' || c == '\'') {
      const std::size_t end = end_of_string(toml, at);
      const std::string_view string = toml.substr(at, end - at);
      line += static_cast<std::size_t>(std::count(string.begin(), string.end(), '\n'));
      at = end;
      continue;
    }
    if (c == '#') {
      at = std::min(toml.find('\n', at), toml.size());
      continue;
    }
    if (c == '.' && ++dots >= kMostKeyParts) return {line, "a key has more than 32 parts"};
    if (c == '\n' || c == '=' || c == ',' || c == '[' || c == '{') dots = 0;
    if ((c == '[' || c == '{') && ++nested > kMostNestedValues) {
      return {line, "values are nested more than 32 deep"};
    }
    if ((c == ']' || c == '}') && nested > 0) --nested;
    if (c == '\n') ++line;
    ++at;
  }
  return {};
}

}  // namespace sandrunner
