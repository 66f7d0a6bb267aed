// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/diagnosis.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <deque>
#include <fstream>
#include <sstream>
#include <string_view>

namespace sandrunner::hil {

constexpr std::size_t kLastLines = 5;

std::set<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  std::set<std::string> words;
  for (std::string word; in >> word;) words.insert(word);
  return words;
}

std::string text_of(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

Diagnosis diagnosis(const std::string& printed) {
  constexpr std::string_view kFailed = "FAILED: ";
  Diagnosis d;
  const std::size_t at = printed.find(kFailed);
  if (at == std::string::npos) return d;
  std::string line =
      printed.substr(at + kFailed.size(), printed.find('\n', at) - at - kFailed.size());
  d.fault = line.substr(0, line.find(' '));
  const std::size_t open = line.find('('), close = line.find(')');
  if (open == std::string::npos || close == std::string::npos) return d;
  line = line.substr(open + 1, close - open - 1);
  std::replace(line.begin(), line.end(), ',', ' ');
  d.joints = words_of(line);
  return d;
}

std::string last_lines(const std::string& printed) {
  std::istringstream in(printed);
  std::deque<std::string> lines;
  for (std::string line; std::getline(in, line);) {
    lines.push_back("    " + line);
    if (lines.size() > kLastLines) lines.pop_front();
  }
  return lines.empty() ? "    nothing" : fmt::format("{}", fmt::join(lines, "\n"));
}

}  // namespace sandrunner::hil
