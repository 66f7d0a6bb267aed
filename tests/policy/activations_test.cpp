// SPDX-License-Identifier: BSD-3-Clause
#include "policy/activations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

namespace sandrunner {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Calls `visit` with floats spread over all exponents from 1e-10 to 100, of both signs.
template <typename Visit>
void for_many_floats(Visit visit) {
  const auto last = std::bit_cast<std::uint32_t>(100.0f);
  for (auto bits = std::bit_cast<std::uint32_t>(1e-10f); bits < last; bits += 331) {
    visit(std::bit_cast<float>(bits));
    visit(-std::bit_cast<float>(bits));
  }
}

TEST(ActivationsTest, TanhStaysWithinItsStatedError) {
  double absolute = 0.0;
  double relative = 0.0;
  for_many_floats([&](float x) {
    const double exact = std::tanh(static_cast<double>(x));
    const double error = std::abs(tanh_approximation(x) - exact);
    absolute = std::max(absolute, error);
    relative = std::max(relative, error / std::abs(exact));
  });
  EXPECT_LT(absolute, 3.1e-7);
  EXPECT_LT(relative, 3.1e-7);
}

TEST(ActivationsTest, SigmoidStaysWithinItsStatedError) {
  double error = 0.0;
  for_many_floats([&](float x) {
    const double exact = 1.0 / (1.0 + std::exp(-static_cast<double>(x)));
    error = std::max(error, std::abs(sigmoid(x) - exact));
  });
  EXPECT_LT(error, 1.9e-7);
}

TEST(ActivationsTest, TanhIsOddAndBounded) {
  for_many_floats([](float x) {
    EXPECT_EQ(tanh_approximation(-x), -tanh_approximation(x));
    EXPECT_LE(std::abs(tanh_approximation(x)), 1.0f);
  });
  EXPECT_EQ(tanh_approximation(0.0f), 0.0f);
  EXPECT_FLOAT_EQ(tanh_approximation(kInfinity), 1.0f);
}

TEST(ActivationsTest, LeakyReluHasSlopeOneHundredthBelowZero) {
  EXPECT_EQ(leaky_relu(2.5f), 2.5f);
  EXPECT_EQ(leaky_relu(0.0f), 0.0f);
  EXPECT_EQ(leaky_relu(-2.0f), -2.0f * 0.01f);
}

TEST(ActivationsTest, ClipLimitsBothSides) {
  EXPECT_EQ(clip(11.0f, 10.0f), 10.0f);
  EXPECT_EQ(clip(-kInfinity, 10.0f), -10.0f);
  EXPECT_EQ(clip(-3.0f, 10.0f), -3.0f);
}

TEST(ActivationsTest, NaNStaysNaN) {
  EXPECT_TRUE(std::isnan(leaky_relu(kNaN)));
  EXPECT_TRUE(std::isnan(clip(kNaN, 10.0f)));
  EXPECT_TRUE(std::isnan(tanh_approximation(kNaN)));
  EXPECT_TRUE(std::isnan(sigmoid(kNaN)));
}

}  // namespace
}  // namespace sandrunner
