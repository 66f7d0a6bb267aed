// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/task/leg_modes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

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

TEST(LegModesTest, FoldedIntoALayerGiveTheActionsOfTheLayerInModes) {
  constexpr std::array<double, kNumLegs> kGain{0.6, 0.7, 0.9, 1.6};
  constexpr std::size_t kInputs = 5;
  std::vector<float> weight(kNumJoints * kInputs), bias(kNumJoints), input(kInputs);
  for (std::size_t i = 0; i < weight.size(); ++i) weight[i] = std::sin(1.0f + 7.0f * float(i));
  for (std::size_t i = 0; i < bias.size(); ++i) bias[i] = std::cos(3.0f * float(i));
  for (std::size_t i = 0; i < input.size(); ++i) input[i] = std::sin(5.0f * float(i) - 1.0f);
  const auto layer = [&](const std::vector<float>& w, const std::vector<float>& b) {
    JointArray<float> out{};
    for (std::size_t row = 0; row < kNumJoints; ++row) {
      out[row] = b[row];
      for (std::size_t c = 0; c < kInputs; ++c) out[row] += w[row * kInputs + c] * input[c];
    }
    return out;
  };
  const JointArray<float> modes = layer(weight, bias);
  JointArray<float> expected;
  joints_from_modes(kGain, modes.data(), 1, expected.data());
  std::vector<float> folded_weight(weight.size()), folded_bias(bias.size());
  joints_from_modes(kGain, weight.data(), kInputs, folded_weight.data());
  joints_from_modes(kGain, bias.data(), 1, folded_bias.data());
  const JointArray<float> folded = layer(folded_weight, folded_bias);
  for (int j = 0; j < kNumJoints; ++j) EXPECT_NEAR(folded[j], expected[j], 1e-6) << j;
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
