// SPDX-License-Identifier: BSD-3-Clause
// The network's activations as branch-free scalar functions, so that a loop over an array
// vectorises. Every element gets the same bits whatever the vector width and the compiler: each
// operation is written out (fma where fused), and none comes from the mathematics library.
#pragma once

#include "rt/core/fma.h"

namespace sandrunner {

/// Slope of the leaky ReLU below zero (the published network, compliant-gym).
inline constexpr float kLeakyReluSlope = 0.01f;

/// x for x > 0, kLeakyReluSlope x else; NaN stays NaN.
inline float leaky_relu(float x) noexcept {
  const float scaled = kLeakyReluSlope * x;
  return scaled > x ? scaled : x;
}

/// x limited to [-limit, limit]; NaN stays NaN, so that the safety gate detects a broken sensor.
inline float clip(float x, float limit) noexcept {
  const float above = x < -limit ? -limit : x;
  return above > limit ? limit : above;
}

/// Hyperbolic tangent; absolute and relative error at most 3.1e-7; NaN stays NaN.
///
/// Rational x P(x^2) / Q(x^2), both of degree 4, the minimax fit of the relative error on [-9, 9]
/// (own Remez exchange, 2.1e-8 before rounding). Beyond 9 tanh is 1 in single precision. All
/// coefficients are positive: nothing cancels.
inline float tanh_approximation(float x) noexcept {
  const float t = clip(x, 9.0f);
  const float s = t * t;
  float p = 1.3354639538451463e-08f;
  p = fma(p, s, 2.060906413632663e-05f);
  p = fma(p, s, 3.495586905501053e-03f);
  p = fma(p, s, 1.3381024564813773e-01f);
  p = fma(p, s, 1.0f);
  float q = 7.77654864917657e-07f;
  q = fma(q, s, 3.285632906224987e-04f);
  q = fma(q, s, 2.587697741289923e-02f);
  q = fma(q, s, 4.671434015516987e-01f);
  q = fma(q, s, 1.0f);
  return clip(t * p / q, 1.0f);
}

/// Exponential linear unit: x above 0, exp(x) - 1 else; absolute error at most 1e-6; NaN stays NaN.
inline float elu(float x) noexcept {
  const float t = tanh_approximation(0.5f * (x < 0.0f ? x : 0.0f));
  const float below = 2.0f * t / (1.0f - t);
  return x < 0.0f ? below : x;
}

/// Logistic function 1 / (1 + exp(-x)); absolute error at most 1.9e-7; NaN stays NaN.
inline float sigmoid(float x) noexcept { return fma(0.5f, tanh_approximation(0.5f * x), 0.5f); }

}  // namespace sandrunner
