// SPDX-License-Identifier: BSD-3-Clause
// What one thread sees. From two threads: exchange_test.cpp.
#include "rt/core/spsc_ring.h"

#include <gtest/gtest.h>

namespace sandrunner {
namespace {

TEST(SpscRingTest, DeliversInOrderAroundTheEnd) {
  SpscRing<int, 4> ring;
  EXPECT_EQ(ring.front(), nullptr);
  int written = 0, read = 0;
  for (int round = 0; round < 25; ++round) {
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(ring.push(++written));
    for (int i = 0; i < 3; ++i) {
      const int* value = ring.front();
      ASSERT_NE(value, nullptr);
      EXPECT_EQ(*value, ++read);
      EXPECT_EQ(ring.front(), value);  // until pop
      ring.pop();
    }
    EXPECT_EQ(ring.front(), nullptr);
  }
  EXPECT_EQ(ring.dropped(), 0u);
}

TEST(SpscRingTest, FullRingDropsTheNewestAndCounts) {
  SpscRing<int, 4> ring;
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(ring.push(i));  // its whole capacity
  for (int i = 4; i < 9; ++i) EXPECT_FALSE(ring.push(i));
  EXPECT_EQ(ring.claim(), nullptr);
  EXPECT_EQ(ring.dropped(), 6u);
  ring.pop();
  EXPECT_TRUE(ring.push(9));  // one place is free again, and only one
  EXPECT_FALSE(ring.push(10));
  EXPECT_EQ(ring.dropped(), 7u);
  for (const int expected : {1, 2, 3, 9}) {
    ASSERT_NE(ring.front(), nullptr);
    EXPECT_EQ(*ring.front(), expected);
    ring.pop();
  }
  EXPECT_EQ(ring.front(), nullptr);
}

TEST(SpscRingTest, ClaimedValueShowsOnlyWhenPublished) {
  SpscRing<int, 2> ring;
  int* place = ring.claim();
  ASSERT_NE(place, nullptr);
  *place = 7;
  EXPECT_EQ(ring.front(), nullptr);
  EXPECT_EQ(ring.claim(), place);  // claimed and not published: the same again
  ring.publish();
  ASSERT_EQ(ring.front(), place);  // in place, not copied
  EXPECT_EQ(*ring.front(), 7);
}

}  // namespace
}  // namespace sandrunner
