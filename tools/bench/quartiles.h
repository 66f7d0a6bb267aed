// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "rt/base/quantile.h"

namespace sandrunner::bench {

/// Median and quartiles of what the rounds gave.
struct Quartiles {
  double median = 0.0, q1 = 0.0, q3 = 0.0;
  std::size_t runs = 0;
};

/// Quartiles of at least one value, linear between neighbours.
inline Quartiles quartiles(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {quantile(values, 0.5), quantile(values, 0.25), quantile(values, 0.75), values.size()};
}

}  // namespace sandrunner::bench
