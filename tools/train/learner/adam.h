// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sandrunner::learner {

/// Moments of Adam (Kingma, Ba 2015), shaped like the parameters.
struct Adam {
  explicit Adam(std::size_t size) : m(size), v(size) {}

  /// Updates parameters [begin, end) by gradient_scale * gradient, as step number `step` (from 1
  /// up). Elementwise: the split into ranges does not change the result.
  void update(std::size_t begin, std::size_t end, double learning_rate, float gradient_scale,
              const float* gradient, float* parameters);

  std::uint64_t step = 0;
  std::vector<float> m;
  std::vector<float> v;
};

}  // namespace sandrunner::learner
