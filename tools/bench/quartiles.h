// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace sandrunner::bench {

/// Median and quartiles of what the rounds gave.
struct Quartiles {
  double median = 0.0, q1 = 0.0, q3 = 0.0;
  std::size_t runs = 0;
};

/// Quartiles of at least one value, linear between neighbours.
inline Quartiles quartiles(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    const double place = share * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return std::lerp(values[below], values[above], place - std::floor(place));
  };
  return {at(0.5), at(0.25), at(0.75), values.size()};
}

}  // namespace sandrunner::bench
