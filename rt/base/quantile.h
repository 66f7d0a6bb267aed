// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

namespace sandrunner {

/// Quantile at `share` in [0, 1] of ascending values, linear between them. nan if there are none.
inline double quantile(const std::vector<double>& ascending, double share) noexcept {
  if (ascending.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double at = share * static_cast<double>(ascending.size() - 1);
  const auto i = static_cast<std::size_t>(at);
  if (i + 1 >= ascending.size()) return ascending.back();
  return ascending[i] + (at - static_cast<double>(i)) * (ascending[i + 1] - ascending[i]);
}

}  // namespace sandrunner
