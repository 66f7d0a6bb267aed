// SPDX-License-Identifier: BSD-3-Clause
// From keys to velocities: no terminal, no clock.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "rt/core/messages.h"

namespace sandrunner::ctl {

/// Speeds at scale 1.
inline constexpr VelocityCommand kFullSpeed = {.vx_mps = 1.0, .vy_mps = 0.5, .wz_radps = 1.0};

inline constexpr char kKeyEscape = '\x1b';
inline constexpr char kKeyCtrlC = '\x03';

/// The keys in what a terminal sent at once. Sequences of special keys (arrows, function keys) are
/// left out; letters come as small ones.
std::vector<char> keys_from(std::string_view bytes);

/// What a key asks for beside a velocity. kStop also ends what a gamepad commands.
enum class KeyAction { kNone, kStop, kStand, kWalk, kDamp, kQuit };

/// Keys to a velocity: w/s forward/back, a/d left/right, q/e turn left/right. The last one counts
/// until no key that steers has come for 0.6 s: longer than a terminal takes to repeat a held key.
class KeyDriver {
 public:
  static constexpr std::int64_t kHold_ns = 600'000'000;

  /// Keys that do not steer end the motion, unknown ones change nothing. + and - change the scale
  /// and count as the last key once more.
  KeyAction press(char key, std::int64_t now_ns);
  /// Nothing: no key is in force.
  std::optional<VelocityCommand> command(std::int64_t now_ns) const;
  /// Tenths of full speed, 1 to 20; 5 at first.
  int scale_tenths() const noexcept { return scale_tenths_; }

 private:
  void rescale(int tenths, std::int64_t now_ns);

  int scale_tenths_ = 5;
  char key_ = '\0';  // that steers; '\0': none
  std::int64_t last_ns_ = 0;
};

}  // namespace sandrunner::ctl
