// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/data/ranks.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "rt/base/errors.h"
#include "tests/tools/train/data/thread_ranks.h"

namespace sandrunner::learner {
namespace {

TEST(RanksTest, SharesAreEveryThingOnceInTheOrderOfTheRanks) {
  for (const int size : {1, 2, 3, 5}) {
    for (const int count : {0, 1, 4, 5, 16, 1'000'003}) {
      std::vector<Share> shares(static_cast<std::size_t>(size));
      run_ranks(size, [&](const Ranks& ranks, int rank) {
        shares[static_cast<std::size_t>(rank)] = ranks.share(count);
      });
      int next = 0;
      for (const Share& share : shares) {
        EXPECT_EQ(share.begin, next);
        EXPECT_LE(share.size(), (count + size - 1) / size);
        next = share.end;
      }
      EXPECT_EQ(next, count);
    }
  }
}

TEST(RanksTest, EachGetsWhatTheOthersHave) {
  for (const int size : {1, 2, 3, 5}) {
    for (const int count : {1, 4, 7}) {
      std::vector<double> expected(3 * static_cast<std::size_t>(count));
      std::iota(expected.begin(), expected.end(), 1.0);
      run_ranks(size, [&](const Ranks& ranks, int) {
        std::vector<double> values(expected.size(), -1.0);
        const Share own = ranks.share(count);
        std::copy(expected.begin() + 3 * own.begin, expected.begin() + 3 * own.end,
                  values.begin() + 3 * own.begin);
        ranks.gather(std::span(values), count);
        EXPECT_EQ(values, expected);
      });
    }
  }
}

TEST(RanksTest, ASumIsAddedInTheOrderOfTheAddendsHoweverManyShareIt) {
  constexpr std::size_t kElements = 40'001;  // more than one range of a pool's task
  constexpr int kAddends = 7;
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  std::vector<std::vector<float>> addends(kAddends, std::vector<float>(kElements));
  for (auto& addend : addends) {
    for (float& value : addend) value = normal(random);
  }
  for (const int count : {1, 2, kAddends}) {
    std::vector<float> expected = addends[0];
    for (int i = 1; i < count; ++i) {
      for (std::size_t k = 0; k < kElements; ++k)
        expected[k] += addends[static_cast<std::size_t>(i)][k];
    }
    for (const int size : {1, 2, 3, 5}) {
      run_ranks(size, [&](const Ranks& ranks, int) {
        WorkerPool pool(2);
        std::vector<std::vector<float>> own(kAddends, std::vector<float>(kElements, -1.0f));
        const Share share = ranks.share(count);
        for (auto i = static_cast<std::size_t>(share.begin);
             i < static_cast<std::size_t>(share.end); ++i)
          own[i] = addends[i];
        ranks.add_up(own, count, pool);
        EXPECT_EQ(own[0], expected);
      });
    }
    WorkerPool pool(2);
    std::vector<std::vector<float>> all = addends;
    Ranks().add_up(all, count, pool);
    EXPECT_EQ(all[0], expected);
  }
}

TEST(RanksTest, WhatHoldsForOneIsKnownToAll) {
  run_ranks(3, [](const Ranks& ranks, int rank) {
    EXPECT_FALSE(ranks.any(false));
    EXPECT_TRUE(ranks.any(rank == 2));
    EXPECT_EQ(ranks.sum(1.0 + rank), 6.0);
    EXPECT_TRUE(ranks.agree(7));
    EXPECT_FALSE(ranks.agree(rank == 1 ? 8 : 7));
    std::vector<std::byte> none;
    EXPECT_THROW(ranks.gather_bytes({none.data(), std::size_t{1} << 31}, 2), InputError);
    EXPECT_EQ(ranks.is_first(), rank == 0);
  });
  EXPECT_TRUE(Ranks().any(true));
  EXPECT_EQ(Ranks().sum(2.5), 2.5);
}

}  // namespace
}  // namespace sandrunner::learner
