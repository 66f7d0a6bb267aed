// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/fixed_text.h"

#include <gtest/gtest.h>

#include <limits>

namespace sandrunner {
namespace {

TEST(FixedTextTest, WhatRoundsToZeroHasNoSign) {
  EXPECT_EQ(fixed_text(-0.004, 2), "0.00");
  EXPECT_EQ(fixed_text(-0.0, 3), "0.000");
  EXPECT_EQ(fixed_text(-0.4, 0), "0");
}

TEST(FixedTextTest, EverythingElseKeepsIt) {
  EXPECT_EQ(fixed_text(-0.006, 2), "-0.01");
  EXPECT_EQ(fixed_text(-10.0, 1), "-10.0");
  EXPECT_EQ(fixed_text(1.5, 1), "1.5");
  EXPECT_EQ(fixed_text(-std::numeric_limits<double>::infinity(), 1), "-inf");
}

}  // namespace
}  // namespace sandrunner
