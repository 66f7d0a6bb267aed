// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/experiments/recovery.h"

#include <gtest/gtest.h>

namespace sandrunner::study {
namespace {

// Walks at 2 m/s; the left front foot meets a patch at 3 s, from when on the speed is 1 m/s for
// `slow_s`. The right front foot swings by 0.1 m four times a second, after the patch by 0.2 m.
Ran made_up_run(double slow_s) {
  Ran run;
  for (int i = 0; i < 800; ++i) {
    Sample s;
    const double t = i * kStep_s;
    s.vx_mps = t >= 3.0 && t < 3.0 + slow_s ? 1.0f : 2.0f;
    s.stance[0] = true;
    s.on_patch[0] = t >= 3.0 && t < 3.1;
    s.stance[1] = i % 25 >= 12;
    s.foot_height_m[1] = s.stance[1] ? 0.03f : t >= 3.0 ? 0.2f : 0.1f;
    run.samples.push_back(s);
  }
  return run;
}

TEST(RecoveryTest, TimeIsUntilTheSpeedIsBackForHalfASecond) {
  // The mean over 0.3 s is back at 90 % when it holds 0.06 s of the slow part.
  EXPECT_NEAR(recovery_of(made_up_run(0.6))->time_s, 0.54, 0.011);
  EXPECT_EQ(recovery_of(made_up_run(0.0))->time_s, 0.0);
}

TEST(RecoveryTest, ARunThatNeverRecoversHasNoTime) {
  EXPECT_TRUE(std::isnan(recovery_of(made_up_run(10.0))->time_s));
}

TEST(RecoveryTest, TheNextSwingIsMeasuredAgainstTheUsualOnes) {
  EXPECT_NEAR(recovery_of(made_up_run(0.6))->swing_ratio, 2.0, 1e-6);
}

TEST(RecoveryTest, ARunThatNeverMetThePatchHasNoRecovery) {
  Ran run = made_up_run(0.6);
  for (Sample& s : run.samples) s.on_patch[0] = false;
  EXPECT_FALSE(recovery_of(run).has_value());
}

}  // namespace
}  // namespace sandrunner::study
