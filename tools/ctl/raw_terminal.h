// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace sandrunner::ctl {

/// The terminal of the standard input without line editing, echo and signal keys: each key is
/// readable at once. As before at the end, also when the program crashes.
class RawTerminal {
 public:
  /// Throws InputError if the standard input is no terminal.
  RawTerminal();
  ~RawTerminal();
  RawTerminal(const RawTerminal&) = delete;
  RawTerminal& operator=(const RawTerminal&) = delete;

  /// Bytes that have come, once the input is readable; empty: the terminal has gone.
  std::string read();
};

}  // namespace sandrunner::ctl
