// SPDX-License-Identifier: BSD-3-Clause
// What is rewarded at first so that a trot is found, and not at all later.
#pragma once

#include <algorithm>
#include <cmath>

#include "tools/train/task/step_outcome.h"

namespace sandrunner::train {

/// Told to go, in any direction, or to turn.
inline bool told_to_move(const StepOutcome& s) {
  return std::fabs(s.command[0]) + std::fabs(s.command[1]) + std::fabs(s.command[2]) >= 0.1f;
}

/// Diagonal feet loaded together and neighbours alternately: 1 in a trot, 0 in a hop or pace,
/// -1 in a bound; 0 if told to stand.
inline double diagonality(const StepOutcome& s) {
  if (!told_to_move(s)) return 0.0;
  const auto& [lf, rf, lh, rh] = s.contact;
  return 0.5 * (double(lf == rh) + double(rf == lh) - double(lf == rf) - double(lh == rh));
}

/// How long a diagonal pair of feet has been in the air while the other one carries, over
/// `target_s`, at most 1; 0 beyond `longest_s`, and if told to stand.
inline double paired_swing(const StepOutcome& s, double target_s, double longest_s) {
  if (!told_to_move(s)) return 0.0;
  const auto pair = [&](int a, int b, int c, int d) {
    if (s.contact[a] || s.contact[b] || !s.contact[c] || !s.contact[d]) return 0.0;
    if (std::max(s.air_s[a], s.air_s[b]) > longest_s) return 0.0;
    return std::min(double(std::min(s.air_s[a], s.air_s[b])) / target_s, 1.0);
  };
  return pair(0, 3, 1, 2) + pair(1, 2, 0, 3);
}

}  // namespace sandrunner::train
