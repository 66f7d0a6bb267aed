// SPDX-License-Identifier: BSD-3-Clause
// From keys to velocities; no terminal, no clock.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rt/core/messages.h"
#include "rt/core/mode_machine.h"

namespace sandrunner::ctl {

/// Speeds at scale 1.
inline constexpr VelocityCommand kFullSpeed = {.vx_mps = 1.0, .vy_mps = 0.5, .wz_radps = 1.0};

inline constexpr char kKeyEscape = '\x1b';
inline constexpr char kKeyCtrlC = '\x03';

/// Finds the keys in what a terminal sends. Sequences of special keys (arrows, function keys) are
/// left out, and so is pasted text, which a terminal in bracketed paste mode marks (ESC [ 200 ~ to
/// ESC [ 201 ~): a pasted word must not arm a robot. Letters become lower case.
class KeyReader {
 public:
  /// The keys in the bytes of one read. A sequence may go on in the next one; an ESC at the end is
  /// the key.
  std::vector<char> keys(std::string_view bytes);

 private:
  std::string rest_;  // the beginning of a sequence
  bool pasting_ = false;
};

/// What a key asks for besides a velocity; mostly nothing.
struct KeyAction {
  const RequestRow* request = nullptr;
  bool quits = false;
};

/// Turns keys into a velocity: w/s forward/backward, a/d left/right, q/e turn left/right. The last
/// of them is in force until no steering key has come for 0.6 s, which is longer than a terminal
/// takes to begin repeating a held key.
class KeyDriver {
 public:
  static constexpr std::int64_t kHold_ns = 600'000'000;

  /// The keys of the other actions end the motion; unknown keys change nothing. + and - change the
  /// scale and keep the key in force for another 0.6 s.
  KeyAction press(char key, std::int64_t now_ns);
  /// The velocity of the key in force; nothing: there is none.
  std::optional<VelocityCommand> command(std::int64_t now_ns) const;
  /// Tenths of full speed, 1 to 20; 5 at first.
  int scale_tenths() const noexcept { return scale_tenths_; }

 private:
  void rescale(int tenths, std::int64_t now_ns);

  int scale_tenths_ = 5;
  const VelocityCommand* steered_ = nullptr;  // by the last steering key, at scale 1; null: none
  std::int64_t last_ns_ = 0;
};

}  // namespace sandrunner::ctl
