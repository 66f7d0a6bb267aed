// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/task/leg_modes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sandrunner::train {
namespace {

TEST(LegModesTest, ModesAreOrthogonal) {
  for (int a = 0; a < kNumLegs; ++a) {
    for (int b = 0; b < kNumLegs; ++b) {
      float product = 0.0f;
      for (const auto& leg : kLegModes) product += leg[a] * leg[b];
      EXPECT_EQ(product, a == b ? 1.0f : 0.0f) << a << " " << b;
    }
  }
}

TEST(LegModesTest, GainScalesFlexionAndNotAbduction) {
  JointArray<float> trot{}, joints{};
  for (const int joint : {0, 1, 2}) trot[9 + joint] = 1.0f;
  joints_from_modes({1.0, 1.0, 1.0, 3.0}, trot.data(), 1, joints.data());
  EXPECT_EQ(joints, (JointArray<float>{0.5f, 1.5f, 1.5f, -0.5f, -1.5f, -1.5f,  //
                                       -0.5f, -1.5f, -1.5f, 0.5f, 1.5f, 1.5f}));
}

TEST(LegModesTest, JointsAndBackGivesTheSameModes) {
  constexpr std::array<double, kNumLegs> kGain{0.6, 0.7, 0.9, 1.6};
  JointArray<float> modes, joints, again;
  for (int k = 0; k < kNumJoints; ++k) modes[k] = std::sin(1.0f + 3.0f * float(k));
  joints_from_modes(kGain, modes.data(), 1, joints.data());
  modes_from_joints(kGain, joints.data(), 1, again.data());
  for (int k = 0; k < kNumJoints; ++k) EXPECT_NEAR(again[k], modes[k], 1e-6) << k;
}

}  // namespace
}  // namespace sandrunner::train
