// SPDX-License-Identifier: BSD-3-Clause
#include "rt/core/command_shaping.h"

#include <gtest/gtest.h>

#include <limits>

namespace sandrunner {
namespace {

TEST(CommandShapingTest, YawRateTimesSpeedStaysWithinTheLimit) {
  EXPECT_DOUBLE_EQ(shape_yaw_rate(2.0, 3.0, 4.0, 2.943), 2.943 / 5.0);
  EXPECT_DOUBLE_EQ(shape_yaw_rate(-2.0, -3.0, 4.0, 2.943), -2.943 / 5.0);
  EXPECT_EQ(shape_yaw_rate(0.5, 3.0, 4.0, 2.943), 0.5);
}

TEST(CommandShapingTest, YawRateIsFreeAtRest) {
  EXPECT_EQ(shape_yaw_rate(7.0, 0.0, 0.0, 2.943), 7.0);
  EXPECT_EQ(shape_yaw_rate(-7.0f, 0.0f, 0.0f, 2.943f), -7.0f);
}

TEST(CommandShapingTest, SlewArrivesExactlyAndNotSooner) {
  double value = 0.0;
  int steps = 0;
  while (value != 1.0) {
    const double next = slew(value, 1.0, 0.3);
    EXPECT_LE(next - value, 0.3 + 1e-15);
    value = next;
    ASSERT_LT(++steps, 10);
  }
  EXPECT_EQ(steps, 4);
  EXPECT_EQ(slew(1.0, -5.0, 0.25), 0.75);
}

TEST(CommandShapingTest, InfiniteSlewPassesStepsThrough) {
  const double off = std::numeric_limits<double>::infinity();
  EXPECT_EQ(slew(0.1, 3.7, off), 3.7);
  EXPECT_EQ(slew(0.1, -3.7, off), -3.7);
}

}  // namespace
}  // namespace sandrunner
