// SPDX-License-Identifier: BSD-3-Clause
// Activation functions in arithmetic of packs, so that every width gives the same bits; double from
// the C library, exact enough for finite differences.
#pragma once

#include <cmath>

#include "sim/lanes/pack.h"

namespace sandrunner::learner {

/// e^x for |x| <= 87, relative error below 2e-7. NaN stays NaN.
template <typename S>
inline S exp_bounded(S x) noexcept {
  // x = n ln 2 + r with |r| <= ln(2) / 2.
  const S n = floor(fma(x, S(1.44269504f), S(0.5f)));
  const S r = fma(n, S(2.12194440e-4f), fma(n, S(-0.693359375f), x));
  // Taylor series: the first term left out is r^8 / 8! < 6e-9.
  S p = fma(r, S(1.0f / 5040.0f), S(1.0f / 720.0f));
  p = fma(p, r, S(1.0f / 120.0f));
  p = fma(p, r, S(1.0f / 24.0f));
  p = fma(p, r, S(1.0f / 6.0f));
  p = fma(p, r, S(0.5f));
  p = fma(p, r, S(1.0f));
  p = fma(p, r, S(1.0f));
  return p * two_to(n);
}

/// 1 / (1 + e^-x), absolute error below 2e-7.
template <typename S>
inline S sigmoid(S x) noexcept {
  const S bounded = min(S(80.0f), max(S(-80.0f), x));  // in this order NaN stays
  return S(1.0f) / (S(1.0f) + exp_bounded(-bounded));
}
inline double sigmoid(double x) noexcept { return 1.0 / (1.0 + std::exp(-x)); }

/// Hyperbolic tangent; absolute error below 4e-7.
template <typename S>
inline S tanh_activation(S x) noexcept {
  return fma(S(2.0f), sigmoid(S(2.0f) * x), S(-1.0f));
}
inline double tanh_activation(double x) noexcept { return std::tanh(x); }

}  // namespace sandrunner::learner
