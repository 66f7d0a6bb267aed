// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/task/gait_prior.h"

#include <gtest/gtest.h>

namespace sandrunner::train {
namespace {

// LF and RH swing, RF and LH carry.
StepOutcome mid_trot(std::array<float, 3> command) {
  StepOutcome s;
  s.command = command;
  s.contact = {false, true, true, false};
  s.air_s = {0.1f, 0.0f, 0.0f, 0.1f};
  return s;
}

TEST(GaitPriorTest, RewardsATrotInEveryDirectionAndInTurns) {
  for (const std::array<float, 3> command : {std::array{1.0f, 0.0f, 0.0f},
                                             {-1.0f, 0.0f, 0.0f},
                                             {0.0f, 0.3f, 0.0f},
                                             {0.0f, -0.3f, 0.0f},
                                             {0.0f, 0.0f, 0.5f},
                                             {0.0f, 0.0f, -0.5f}}) {
    EXPECT_EQ(diagonality(mid_trot(command)), 1.0);
    EXPECT_NEAR(paired_swing(mid_trot(command), 0.25, 0.35), 0.4, 1e-6);
  }
}

TEST(GaitPriorTest, IsNothingUnderACommandToStand) {
  EXPECT_EQ(diagonality(mid_trot({})), 0.0);
  EXPECT_EQ(paired_swing(mid_trot({}), 0.25, 0.35), 0.0);
}

TEST(GaitPriorTest, DiagonalityOfAHopOrPaceIsZeroAndOfABoundBelow) {
  StepOutcome s;
  s.command = {1.0f, 0.0f, 0.0f};
  EXPECT_EQ(diagonality(s), 0.0);  // all in the air
  s.contact = {true, true, true, true};
  EXPECT_EQ(diagonality(s), 0.0);
  s.contact = {true, true, false, false};
  EXPECT_EQ(diagonality(s), -1.0);
  s.contact = {true, false, true, false};
  EXPECT_EQ(diagonality(s), 0.0);
}

TEST(GaitPriorTest, SwingOfAPairIsRewardedByItsShorterFootWhileTheOthersCarry) {
  StepOutcome s = mid_trot({1.0f, 0.0f, 0.0f});
  s.air_s[3] = 0.2f;
  EXPECT_NEAR(paired_swing(s, 0.25, 0.35), 0.4, 1e-6);
  s.air_s[3] = 0.36f;
  EXPECT_EQ(paired_swing(s, 0.25, 0.35), 0.0);
  s.air_s = {0.3f, 0.0f, 0.0f, 0.3f};
  EXPECT_EQ(paired_swing(s, 0.25, 0.35), 1.0);
  s.contact[1] = false;
  EXPECT_EQ(paired_swing(s, 0.25, 0.35), 0.0);
}

}  // namespace
}  // namespace sandrunner::train
