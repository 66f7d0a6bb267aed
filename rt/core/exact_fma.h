// SPDX-License-Identifier: BSD-3-Clause
// The fused multiply-add out of rounded operations, for a machine that has none. Source: Boldo and
// Melquiond, "Emulation of a FMA and correctly rounded sums: proved algorithms using rounding to
// odd", IEEE Transactions on Computers 57 (2008), algorithm Fmaodd.
#pragma once

#include <bit>
#include <cstdint>

namespace sandrunner {

/// a + b as a rounded sum, and the error of that.
inline double two_sum(double a, double b, double& error) noexcept {
  const double sum = a + b, part = sum - a;
  error = (a - (sum - part)) + (b - part);
  return sum;
}

/// a + b rounded to odd: where it is not exact, to that neighbour whose last bit is 1.
inline double odd_sum(double a, double b) noexcept {
  double error;
  const double sum = two_sum(a, b, error);
  const auto bits = std::bit_cast<std::int64_t>(sum);
  // Away from zero if the error has the sum's sign, else towards it. Without a branch, which no
  // processor could foresee.
  const std::int64_t outwards = 1 | ((bits ^ std::bit_cast<std::int64_t>(error)) >> 63);
  const std::int64_t moves = static_cast<std::int64_t>(error != 0.0) & ~bits & 1;
  return std::bit_cast<double>(bits + outwards * moves);
}

/// a b + c, rounded once. Exact while no product, nor an error of one, leaves the range of normal
/// numbers: |a|, |b| below 2^996, and |a b| 0 or above 2^-968. Infinities may become NaN.
inline double exact_fma(double a, double b, double c) noexcept {
  const double product = a * b;
  if (product == 0.0 || c == 0.0) return product + c;  // with the sign of zero
  // Dekker's product: its error, out of halves of 26 bits.
  constexpr double kSplit = 134217729.0;  // 2^27 + 1
  const double ka = kSplit * a, a_high = ka - (ka - a), a_low = a - a_high;
  const double kb = kSplit * b, b_high = kb - (kb - b), b_low = b - b_high;
  const double error =
      ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
  double low, rest;
  const double high = two_sum(c, error, low);
  const double sum = two_sum(product, high, rest);
  return sum + odd_sum(low, rest);
}

/// The product of two floats is exact in double, and double has the bits to round to odd.
inline float exact_fma(float a, float b, float c) noexcept {
  return static_cast<float>(
      odd_sum(static_cast<double>(a) * static_cast<double>(b), static_cast<double>(c)));
}

}  // namespace sandrunner
