// SPDX-License-Identifier: BSD-3-Clause
#include "rt/core/log_histogram.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace sandrunner {
namespace {

constexpr std::int64_t kLongest_ns = std::numeric_limits<std::int64_t>::max();

TEST(LogHistogramTest, EmptyGivesZero) {
  const LogHistogram histogram;
  EXPECT_EQ(histogram.count(), 0u);
  EXPECT_EQ(histogram.max_ns(), 0u);
  EXPECT_EQ(histogram.quantile_ns(0.5), 0u);
}

TEST(LogHistogramTest, Below128NanosecondsIsExact) {
  LogHistogram histogram;
  for (int v = 0; v < 128; ++v) histogram.add(v);
  for (int v = 0; v < 128; ++v) EXPECT_EQ(histogram.quantile_ns((v + 1) / 128.0), v);
}

TEST(LogHistogramTest, EveryDurationIsWithinA64thFromAbove) {
  for (int exponent = 0; exponent < 63; ++exponent) {
    const std::int64_t power = std::int64_t{1} << exponent;
    for (const std::int64_t v :
         {power - 1, power, power + 1, power + power / 2, power + (power - 1)}) {
      LogHistogram histogram;
      histogram.add(v);
      EXPECT_EQ(histogram.quantile_ns(1.0), v);  // never above the maximum
      histogram.add(kLongest_ns);
      const std::uint64_t q = histogram.quantile_ns(0.5);
      EXPECT_GE(q, v);
      EXPECT_LE(q - v, v / 64) << v;
    }
  }
}

TEST(LogHistogramTest, QuantilesOfManyAreRightToA64th) {
  LogHistogram histogram;
  constexpr int kCount = 100000;
  for (int i = 1; i <= kCount; ++i) histogram.add(std::int64_t{7} * i);
  EXPECT_EQ(histogram.count(), 100000u);
  EXPECT_EQ(histogram.max_ns(), 700000u);
  for (const double share : {0.001, 0.1, 0.5, 0.9, 0.99, 0.999, 0.9999}) {
    const auto q = static_cast<double>(histogram.quantile_ns(share));
    EXPECT_GE(q, 7.0 * kCount * share - 1e-6) << share;
    EXPECT_LE(q, 7.0 * kCount * share * 65.0 / 64.0 + 7.0) << share;
  }
  EXPECT_EQ(histogram.quantile_ns(1.0), 700000u);
  EXPECT_EQ(histogram.quantile_ns(0.0), 7u);  // the smallest
}

TEST(LogHistogramTest, OneOutlierInAThousandIsNotInTheShareBelowIt) {
  for (const int thousands : {1, 2, 7, 48, 300}) {
    LogHistogram histogram;
    for (int i = 0; i < 999 * thousands; ++i) histogram.add(10);
    for (int i = 0; i < thousands; ++i) histogram.add(1'000'000);
    EXPECT_EQ(histogram.quantile_ns(0.999), 10u) << thousands;
    EXPECT_EQ(histogram.quantile_ns(0.9991), 1'000'000u) << thousands;
  }
}

TEST(LogHistogramTest, NegativeCountsAsZeroAndTheLongestFits) {
  LogHistogram histogram;
  histogram.add(-5);
  histogram.add(std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(histogram.max_ns(), 0u);
  EXPECT_EQ(histogram.quantile_ns(1.0), 0u);
  histogram.add(kLongest_ns);
  EXPECT_EQ(histogram.count(), 3u);
  EXPECT_EQ(histogram.max_ns(), kLongest_ns);
  EXPECT_EQ(histogram.quantile_ns(1.0), kLongest_ns);
  EXPECT_EQ(histogram.quantile_ns(0.6), 0u);
}

}  // namespace
}  // namespace sandrunner
