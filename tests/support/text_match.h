// SPDX-License-Identifier: BSD-3-Clause
// POSIX regular expressions: std::regex costs every file that includes it four seconds of the
// compiler.
#pragma once

#include <regex.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace sandrunner {

/// Every place where the text matches the extended pattern, from the front on: what matched, then
/// its groups, empty for one that had no part in it. `.` ends with the line. Throws
/// std::invalid_argument for a bad pattern.
inline std::vector<std::vector<std::string>> matches_in(const std::string& text,
                                                        const std::string& pattern) {
  regex_t compiled;
  if (regcomp(&compiled, pattern.c_str(), REG_EXTENDED | REG_NEWLINE) != 0)
    throw std::invalid_argument(pattern);
  std::vector<std::vector<std::string>> found;
  std::vector<regmatch_t> spans(compiled.re_nsub + 1);
  std::size_t from = 0;
  while (from <= text.size() && regexec(&compiled, text.c_str() + from, spans.size(), spans.data(),
                                        from == 0 ? 0 : REG_NOTBOL) == 0) {
    std::vector<std::string>& match = found.emplace_back();
    for (const regmatch_t& span : spans) {
      match.push_back(span.rm_so < 0
                          ? ""
                          : text.substr(from + static_cast<std::size_t>(span.rm_so),
                                        static_cast<std::size_t>(span.rm_eo - span.rm_so)));
    }
    const auto end = static_cast<std::size_t>(spans[0].rm_eo);
    from += end == static_cast<std::size_t>(spans[0].rm_so) ? end + 1 : end;
  }
  regfree(&compiled);
  return found;
}

}  // namespace sandrunner
