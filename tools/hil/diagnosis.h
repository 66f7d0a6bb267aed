// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <set>
#include <string>

namespace sandrunner::hil {

/// What a controller printed of its end: "FAILED: joints_stale (LF_KFE) in walk, after 0.00 s of
/// Walk". Both empty: it did not fail.
struct Diagnosis {
  std::string fault;
  std::set<std::string> joints;
};
Diagnosis diagnosis(const std::string& printed);

/// The words of a text with blanks between.
std::set<std::string> words_of(const std::string& text);

/// The last lines of what a process printed, indented, for a message.
std::string last_lines(const std::string& printed);

/// A whole file; empty: it cannot be read.
std::string text_of(const std::string& path);

}  // namespace sandrunner::hil
