// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <utility>

#include "rt/core/messages.h"
#include "rt/loop/tick_record.h"

namespace sandrunner {

/// A foot on the ground. It begins at penetration >= 0, ends when the contact point is 1 mm above
/// the surface, and counts if it lasted 10 ms.
struct Stance {
  int ticks = 0;        ///< 0: in the air
  Vector3 deepest_m{};  ///< world x, y and depth where the foot was deepest so far
};

/// Follows the stances of all feet of a robot that offers its truth.
class StanceWatch {
 public:
  /// Every tick, in order. Calls `ended(leg, time_s, stance)` for each stance that ends and counts.
  template <typename Ended>
  void add(const TickRecord& tick, const Ended& ended) {
    constexpr int kShortest_ticks = kControlHz / 100;
    constexpr double kLift_m = 0.001;
    for (std::size_t l = 0; l < kNumLegs; ++l) {
      Stance& stance = stances_[l];
      const double depth_m = tick.truth.foot_penetration_m[l];
      if (stance.ticks == 0 && !(depth_m >= 0.0)) continue;
      ++stance.ticks;
      if (depth_m > stance.deepest_m[2]) {
        const Vector3& centre = tick.truth.foot_centre_m[l];
        stance.deepest_m = {centre[0], centre[1], depth_m};
      }
      if (depth_m > -kLift_m) continue;
      const Stance whole = std::exchange(stance, {});
      if (whole.ticks < kShortest_ticks) continue;
      ended(l, static_cast<double>(tick.input.sensors.tick + 1) * kControlPeriod_s, whole);
    }
  }

  const std::array<Stance, kNumLegs>& stances() const noexcept { return stances_; }

 private:
  std::array<Stance, kNumLegs> stances_;
};

}  // namespace sandrunner
