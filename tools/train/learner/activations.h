// SPDX-License-Identifier: BSD-3-Clause
// Activation functions as plain arithmetic, so that compilers vectorise loops over them and every
// lane gives the same bits. float: for training. double: from the C library, exact enough for
// finite differences.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace sandrunner::learner {

/// Slope of leaky ReLU for negative input (paper's networks).
template <typename Scalar>
inline constexpr Scalar kLeakySlope = static_cast<Scalar>(0.01);

/// e^x for |x| <= 87, relative error below 2e-7. NaN stays NaN.
inline float exp_bounded(float x) {
  // x = n ln 2 + r with |r| <= ln(2) / 2; adding and subtracting 1.5 * 2^23 rounds to the nearest
  // integer.
  constexpr float kRound = 12582912.0f;
  const float n = (x * 1.44269504f + kRound) - kRound;
  const float r = (x - n * 0.693359375f) + n * 2.12194440e-4f;
  // Taylor series: the first term left out is r^8 / 8! < 6e-9.
  float p = 1.0f / 5040.0f;
  p = p * r + 1.0f / 720.0f;
  p = p * r + 1.0f / 120.0f;
  p = p * r + 1.0f / 24.0f;
  p = p * r + 1.0f / 6.0f;
  p = p * r + 0.5f;
  p = p * r + 1.0f;
  p = p * r + 1.0f;
  return p * std::bit_cast<float>((static_cast<std::int32_t>(n) + 127) << 23);
}

/// 1 / (1 + e^-x), absolute error below 2e-7.
inline float sigmoid(float x) {
  const float low = x < -80.0f ? -80.0f : x;
  const float bounded = low > 80.0f ? 80.0f : low;
  return 1.0f / (1.0f + exp_bounded(-bounded));
}
inline double sigmoid(double x) { return 1.0 / (1.0 + std::exp(-x)); }

/// Hyperbolic tangent; float: absolute error below 4e-7.
inline float tanh_activation(float x) { return 2.0f * sigmoid(2.0f * x) - 1.0f; }
inline double tanh_activation(double x) { return std::tanh(x); }

}  // namespace sandrunner::learner
