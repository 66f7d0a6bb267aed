// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

namespace sandrunner {

/// The whole number nearest to `scaled` (not NaN), from `low` to `high`. A tie goes towards zero,
/// where firmwares that cut the fraction off go too: no gain is above the one asked for by a tie.
inline double nearest_code(double scaled, double low, double high) noexcept {
  const double magnitude = std::ceil(std::fabs(scaled) - 0.5);
  return std::clamp(std::copysign(magnitude, scaled), low, high);
}

}  // namespace sandrunner
