// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace sandrunner::ctl {

/// The terminal on standard input without line editing, echo and signal keys: each key can be read
/// at once. At the end, even after a crash of the program, the terminal is as it was before.
class RawTerminal {
 public:
  /// Throws InputError if standard input is not a terminal.
  RawTerminal();
  ~RawTerminal();
  RawTerminal(const RawTerminal&) = delete;
  RawTerminal& operator=(const RawTerminal&) = delete;

  /// Waits for input and returns it; empty: the terminal is gone.
  std::string read();
};

}  // namespace sandrunner::ctl
