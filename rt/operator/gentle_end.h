// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "rt/loop/operator_input.h"

namespace sandrunner {

/// A robot that has not lain down after this time is damped where it is: with the damping, a run
/// ends within 6 s.
inline constexpr std::uint64_t kLongestEnd_ticks = 5 * kControlHz;

/// How a run ends: the robot stops, lies down and is damped for kDampingEnd_ticks. `damp` skips
/// what comes before the damping. For the control thread.
class GentleEnd {
 public:
  bool begun() const noexcept { return begun_; }
  /// From now on. Each returns the request that is due, kNone if it was made before.
  ModeRequest lie() noexcept;
  ModeRequest damp() noexcept;

  /// Looks at `ticks` ticks that ended in `mode`. Returns the request that is due, or kNone.
  ModeRequest advance(Mode mode, std::uint64_t ticks) noexcept;
  /// The robot has been damped for long enough, or its drives are off.
  bool done() const noexcept { return done_; }

 private:
  bool begun_ = false, damps_ = false, done_ = false;
  std::uint64_t ticks_ = 0, damped_ticks_ = 0;
};

}  // namespace sandrunner
