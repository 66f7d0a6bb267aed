// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>

namespace sandrunner {

/// Input from outside (option, file, key, value) that cannot be used. `what()` is one line that
/// names what was found, where, and what was expected. Programs print it and exit with
/// kExitBadInput. Never thrown in real time.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Replaces control characters, which a terminal would obey: those of ASCII, and the 32 more of
/// UTF-8, of two bytes.
inline void replace_controls(std::string& text, char with) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : 0);
    if (byte < 0x20 || byte == 0x7f) text[i] = with;
    if (byte == 0xc2 && next >= 0x80 && next < 0xa0) text[i] = text[i + 1] = with;
  }
}

/// An error message as the one line that a program prints: what it quotes of the user's may hold
/// line breaks, and be long, which costs the message its middle.
inline std::string one_line(std::string message) {
  constexpr std::size_t kLongest = 1000, kEnd = 300;
  if (message.size() > kLongest) {
    message.replace(kLongest - kEnd, message.size() - kLongest, " ... ");
  }
  replace_controls(message, ' ');
  return message;
}

/// Exit codes of all programs.
inline constexpr int kExitOk = 0;
/// What the program checks or runs failed: the robot fell or a fault latched, a recording differs
/// from its replay, a check found a problem. Results are still written.
inline constexpr int kExitFailed = 1;
inline constexpr int kExitBadInput = 2;
inline constexpr int kExitInternal = 3;

}  // namespace sandrunner
