// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/quantile.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sandrunner {
namespace {

TEST(QuantileTest, InterpolatesBetweenValues) {
  EXPECT_EQ(quantile({1.0, 2.0, 4.0}, 0.0), 1.0);
  EXPECT_EQ(quantile({1.0, 2.0, 4.0}, 0.75), 3.0);
  EXPECT_EQ(quantile({1.0, 2.0, 4.0}, 1.0), 4.0);
  EXPECT_EQ(quantile({5.0}, 0.3), 5.0);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

}  // namespace
}  // namespace sandrunner
