// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/not_finite.h"

namespace sandrunner::evaluate {
namespace {

// Wilson's intervals as tabulated, e.g. by R's prop.test(correct = FALSE).
TEST(StatisticsTest, RateIntervalsAreWilsons) {
  const Estimate half = rate_interval(50, 100);
  EXPECT_EQ(half.value, 0.5);
  EXPECT_NEAR(half.low, 0.4038, 1e-4);
  EXPECT_NEAR(half.high, 0.5962, 1e-4);
  const Estimate none = rate_interval(0, 10);
  EXPECT_EQ(none.low, 0.0);
  EXPECT_NEAR(none.high, 0.2775, 1e-4);
  const Estimate all = rate_interval(360, 360);
  EXPECT_NEAR(all.low, 0.9894, 1e-4);
  EXPECT_EQ(all.high, 1.0);
  EXPECT_EQ(rate_interval(0, 0).n, 0);
}

TEST(StatisticsTest, StudentQuantilesAreThoseOfTheTables) {
  const std::pair<int, double> table[] = {{1, 12.7062}, {2, 4.3027},  {5, 2.5706},  {6, 2.4469},
                                          {9, 2.2622},  {15, 2.1314}, {30, 2.0423}, {359, 1.9666}};
  for (const auto& [degrees, expected] : table) {
    EXPECT_NEAR(student_t_975(degrees), expected, 0.002 * expected) << degrees;
  }
}

TEST(StatisticsTest, MeanIntervalLeavesOutWhatIsNotDefined) {
  const Estimate e = mean_interval({1.0, kNan, 2.0, 3.0, 4.0, kNan, 5.0});
  EXPECT_EQ(e.n, 5);
  EXPECT_EQ(e.value, 3.0);
  EXPECT_NEAR(e.high - e.value, 1.9632, 1e-4);  // 2.7764 sqrt(2.5/5)
  EXPECT_NEAR(e.value - e.low, 1.9632, 1e-4);
  EXPECT_EQ(mean_interval({kNan}).n, 0);
  EXPECT_TRUE(std::isnan(mean_interval({}).value));
  EXPECT_EQ(mean_interval({2.0}).value, 2.0);
  EXPECT_TRUE(std::isnan(mean_interval({2.0}).high)) << "one value says nothing of the spread";
}

TEST(StatisticsTest, RmsPoolsSquares) {
  const Estimate e = rms_interval({3.0, 4.0, kNan});
  EXPECT_EQ(e.n, 2);
  EXPECT_NEAR(e.value, std::sqrt(12.5), 1e-12);
  EXPECT_EQ(e.low, 0.0);  // the interval of the mean square reaches below zero
  EXPECT_GT(e.high, e.value);
}

TEST(StatisticsTest, InterpolatesBetweenPointsInAnyOrder) {
  const std::vector<std::pair<double, double>> points = {{2.0, 30.0}, {0.0, 10.0}, {1.0, 20.0}};
  EXPECT_EQ(interpolate(points, 0.5), 15.0);
  EXPECT_EQ(interpolate(points, 2.0), 30.0);
  EXPECT_TRUE(std::isnan(interpolate(points, 2.1)));
  EXPECT_TRUE(std::isnan(interpolate(points, -0.1)));
  EXPECT_TRUE(std::isnan(interpolate({{1.0, 1.0}}, 1.0))) << "one point is no line";
}

}  // namespace
}  // namespace sandrunner::evaluate
