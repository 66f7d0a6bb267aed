// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace sandrunner::learner {

/// Mirror image of a vector: element i is sign[i] times element index[i] of the original.
struct Reflection {
  std::vector<int> index;
  std::vector<float> sign;

  /// As original and image share `column`, an Eigen vector. `scratch`: as long as the vector.
  template <typename Column, typename Scalar>
  void apply(Column&& column, Scalar* scratch) const {
    for (std::size_t i = 0; i < index.size(); ++i) {
      scratch[i] = static_cast<Scalar>(sign[i]) * column(index[i]);
    }
    for (std::size_t i = 0; i < index.size(); ++i) column(static_cast<int>(i)) = scratch[i];
  }
};

/// How the data of a task look in a mirror in which the task itself looks the same. Each is its own
/// inverse.
struct Symmetry {
  Reflection observation, action;
  Reflection insight;  ///< where a network sees it
};

}  // namespace sandrunner::learner
