// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/likely_meant.h"

#include <gtest/gtest.h>

namespace sandrunner {
namespace {

const std::vector<std::string> kKnown = {"controller.stand.kp_nmprad",
                                         "controller.walk.kp_nmprad",
                                         "dry-sand",
                                         "terrain.friction",
                                         "--from",
                                         "--to"};

TEST(LikelyMeantTest, FindsSlipsOfTheKeyboardUnitsLeftOutAndOtherTables) {
  EXPECT_EQ(likely_meant("dry-snad", kKnown), "dry-sand");
  EXPECT_EQ(likely_meant("controller.walk.kp", kKnown), "controller.walk.kp_nmprad");
  EXPECT_EQ(likely_meant("ground.friction", kKnown), "terrain.friction");
  EXPECT_EQ(likely_meant("--form", kKnown), "--from");
}

TEST(LikelyMeantTest, SaysNothingWithoutALikelyOne) {
  EXPECT_EQ(did_you_mean("mud", kKnown), "");
  EXPECT_EQ(did_you_mean("--gui", {"--out", "--set"}), "");
  EXPECT_EQ(did_you_mean("", kKnown), "");
  EXPECT_EQ(did_you_mean(std::string(100'000, 'a'), kKnown), "");
  EXPECT_EQ(did_you_mean("--form", kKnown), ", did you mean '--from'?");
}

}  // namespace
}  // namespace sandrunner
