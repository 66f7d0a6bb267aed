// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/kernels/activations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace sandrunner::learner {
namespace {

using S = sim::Pack<8>;

float lane(S s) {
  float lanes[8];
  store(s, lanes);
  return lanes[0];
}

TEST(ActivationsTest, AreWithinTheirStatedErrorOfTheLibrary) {
  double sigmoid_error = 0.0;
  double tanh_error = 0.0;
  for (int i = -400000; i <= 400000; ++i) {
    const float x = static_cast<float>(i) * 2.5e-4f;  // +-100
    const auto exact = static_cast<double>(x);
    const auto s = static_cast<double>(lane(sigmoid(S(x))));
    const auto t = static_cast<double>(lane(tanh_activation(S(x))));
    sigmoid_error = std::max(sigmoid_error, std::abs(s - sigmoid(exact)));
    tanh_error = std::max(tanh_error, std::abs(t - std::tanh(exact)));
  }
  EXPECT_LE(sigmoid_error, 2e-7);
  EXPECT_LE(tanh_error, 4e-7);
}

TEST(ActivationsTest, KeepNotANumberAndSaturate) {
  EXPECT_TRUE(std::isnan(lane(sigmoid(S(std::nanf(""))))));
  EXPECT_TRUE(std::isnan(lane(tanh_activation(S(std::nanf(""))))));
  EXPECT_EQ(lane(sigmoid(S(1e30f))), 1.0f);
  EXPECT_EQ(lane(tanh_activation(S(-1e30f))), -1.0f);
}

}  // namespace
}  // namespace sandrunner::learner
