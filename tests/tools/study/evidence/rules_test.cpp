// SPDX-License-Identifier: BSD-3-Clause
// The terms of CLAIMS.md on made-up figures.
#include "tools/study/evidence/rules.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/not_finite.h"
#include "tools/study/claims/paper.h"

namespace sandrunner::study {
namespace {

// A value for each seed, its runs scattered around it.
Figure made_up(const std::vector<double>& values, double scatter = 0.01, int runs = 8) {
  Figure figure;
  for (std::size_t s = 0; s < values.size(); ++s) {
    SeedValue& seed = figure[static_cast<int>(s) + 1];
    seed.value = values[s];
    for (int i = 0; i < runs; ++i) seed.runs.push_back(values[s] + scatter * (i % 3 - 1));
  }
  return figure;
}

TEST(RulesTest, AboveNeedsEveryPairOfSeeds) {
  EXPECT_TRUE(above(made_up({3.0, 2.9}), made_up({2.0, 2.1})).holds);
  EXPECT_FALSE(above(made_up({3.0, 2.0}), made_up({2.0, 2.1})).holds);
}

TEST(RulesTest, AboveNeedsItsMargin) {
  EXPECT_TRUE(above(made_up({3.0}), made_up({2.0}), 0.9).holds);
  EXPECT_FALSE(above(made_up({3.0}), made_up({2.0}), 1.1).holds);
  EXPECT_TRUE(above_by_share(made_up({3.0}), made_up({2.0}), 0.4).holds);
  EXPECT_FALSE(above_by_share(made_up({3.0}), made_up({2.0}), 0.6).holds);
  EXPECT_TRUE(below_by_share(made_up({2.0}), made_up({3.0}), 0.3).holds);
  EXPECT_FALSE(below_by_share(made_up({2.0}), made_up({3.0}), 0.4).holds);
}

TEST(RulesTest, AboveNeedsAPairedDifferenceThatIsNotChance) {
  // The means differ by 0.5, the differences of single runs scatter by 3.
  Figure a = made_up({3.5}), b = made_up({3.0});
  for (std::size_t i = 0; i < 8; ++i) a[1].runs[i] += i % 2 == 0 ? 3.0 : -3.0;
  EXPECT_FALSE(above(a, b).holds);
}

TEST(RulesTest, AboveNeedsEightPairsOfRuns) {
  Figure a = made_up({3.0}), b = made_up({2.0});
  EXPECT_EQ(above(a, b).pairs, 8);
  a[1].runs[4] = kNan;
  EXPECT_EQ(above(a, b).pairs, 7);
  EXPECT_FALSE(above(a, b).holds);
}

TEST(RulesTest, AboveUsesTheRunsOfTheFirstCommonSeed) {
  Figure a = made_up({3.0, 3.0}), b = made_up({2.0, 2.0});
  a.erase(1);
  b[1].runs.assign(8, 100.0);
  EXPECT_TRUE(above(a, b).holds);
}

TEST(RulesTest, AboutIsFifteenPercentAndFarIsThirtyOfEverySeed) {
  EXPECT_TRUE(is_about(made_up({1.14}), 1.0));
  EXPECT_FALSE(is_about(made_up({1.16}), 1.0));
  EXPECT_FALSE(is_far_from(made_up({1.29}), 1.0));
  EXPECT_TRUE(is_far_from(made_up({1.31}), 1.0));
  EXPECT_FALSE(is_far_from(made_up({1.31, 1.2}), 1.0));
  EXPECT_TRUE(is_about(made_up({0.76}), 1.0, 0.25));
}

TEST(RulesTest, ShareIsFifteenPointsAndFarIsThirtyOfEverySeed) {
  EXPECT_TRUE(is_share(made_up({0.5}), 0.375));
  EXPECT_FALSE(is_share(made_up({0.6}), 0.375));
  EXPECT_FALSE(is_far_from_share(made_up({0.6}), 0.375));
  EXPECT_TRUE(is_far_from_share(made_up({0.7}), 0.375));
}

TEST(RulesTest, AFigureThatASeedLacksHasNoMedian) {
  EXPECT_TRUE(std::isnan(median(made_up({1.0, kNan}))));
  EXPECT_TRUE(std::isnan(median({})));
  EXPECT_FALSE(is_about(made_up({kNan}), 1.0));
  EXPECT_FALSE(is_far_from({}, 1.0));
  EXPECT_EQ(median(made_up({3.0, 1.0, 2.0})), 2.0);
}

TEST(RulesTest, FiguresArePrintedWithTheirRangeOverSeeds) {
  EXPECT_EQ(printed(made_up({1.25}), 1.0, 2), "1.25");
  EXPECT_EQ(printed(made_up({0.3, 0.1, 0.2}), 100.0, 0), "20 [10, 30]");
  EXPECT_EQ(printed(made_up({kNan}), 1.0, 2), "not defined");
}

TEST(RulesTest, KendallsTauIsOneForTheSameOrderAndMinusOneForTheReverse) {
  EXPECT_EQ(kendall_tau({1, 2, 3, 4}, {10, 20, 30, 40}), 1.0);
  EXPECT_EQ(kendall_tau({1, 2, 3, 4}, {4, 3, 2, 1}), -1.0);
  EXPECT_NEAR(kendall_tau({1, 2, 3, 4}, {2, 1, 3, 4}), 4.0 / 6.0, 1e-12);
}

TEST(PaperTest, TopSpeedsOfTableOneGiveTheRatiosOfTheText) {
  const auto top = [](std::string_view key) {
    for (const paper::BeachRow& row : paper::kBeach) {
      if (key == row.controller) return row.top_mps;
    }
    return kNan;
  };
  EXPECT_NEAR(top("ours") / top("pl-rigid") - 1.0, paper::kFasterThanPlRigid, 0.0005);
  EXPECT_NEAR(top("ours") / top("pl-gm") - 1.0, paper::kFasterThanPlGm, 0.0005);
}

TEST(PaperTest, SuccessRatesAreWholeTrialsOfForty) {
  for (const paper::BeachRow& row : paper::kBeach) {
    if (std::isnan(row.success)) continue;
    EXPECT_NEAR(40.0 * row.success, std::round(40.0 * row.success), 1e-9) << row.controller;
  }
}

}  // namespace
}  // namespace sandrunner::study
