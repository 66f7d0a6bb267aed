// SPDX-License-Identifier: BSD-3-Clause
// The last activation of the encoders that are no LSTM.
#pragma once

#include <cmath>

#include "policy/activations.h"
#include "tools/train/learner/matrix.h"

namespace sandrunner::learner {

/// Hyperbolic tangent: float with the same bits on every processor, double from the C library.
inline float hyperbolic_tangent(float x) noexcept { return tanh_approximation(x); }
inline double hyperbolic_tangent(double x) noexcept { return std::tanh(x); }

template <typename Scalar>
void apply_tanh(Matrix<Scalar>& x) {
  for (Eigen::Index i = 0; i < x.size(); ++i) x.data()[i] = hyperbolic_tangent(x.data()[i]);
}

/// dL/d tanh(x) -> dL/dx.
template <typename Scalar>
auto before_tanh(const Matrix<Scalar>& tanh_x, const Matrix<Scalar>& gradient) {
  return gradient.cwiseProduct((1 - tanh_x.array().square()).matrix());
}

}  // namespace sandrunner::learner
