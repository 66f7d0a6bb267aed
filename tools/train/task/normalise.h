// SPDX-License-Identifier: BSD-3-Clause
// Fixed scales of the network's input and estimate. Running statistics would change the meaning of
// the input while the curriculum moves; round numbers do not.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "rt/core/messages.h"

namespace sandrunner::train {

struct InputScales {
  std::array<float, kObservationSize> mean{}, inverse_deviation{};
  std::array<float, kEstimateSize> estimate_mean{}, estimate_deviation{};
  float clip = 6.0f;
};

/// Gravity x 8 (z about 0.98), angular velocity x 1, (q - nominal) x 3, joint velocity x 1/3, 1/4,
/// 1/7 (HAA, HFE, KFE), command x 1, 2, 1. Estimate: height 0.05 m about `body_height_m`, velocity
/// 0.7, 0.3, 0.2 m/s, foot heights 0.07 m about 0.03.
inline InputScales make_scales(const JointArray<double>& nominal_rad, double body_height_m,
                               double clip) {
  InputScales s;
  s.clip = static_cast<float>(clip);
  s.inverse_deviation = {1, 2, 1, 8, 8, 8, 1, 1, 1};
  s.mean[5] = 0.98f;
  constexpr float kVelocity[3] = {1.0f / 3.0f, 1.0f / 4.0f, 1.0f / 7.0f};
  for (int j = 0; j < kNumJoints; ++j) {
    s.mean[9 + j] = static_cast<float>(nominal_rad[j]);
    s.inverse_deviation[9 + j] = 3.0f;
    s.inverse_deviation[9 + kNumJoints + j] = kVelocity[j % 3];
  }
  s.estimate_mean = {static_cast<float>(body_height_m), 0, 0, 0, 0.03f, 0.03f, 0.03f, 0.03f};
  s.estimate_deviation = {0.05f, 0.7f, 0.3f, 0.2f, 0.07f, 0.07f, 0.07f, 0.07f};
  return s;
}

/// (x - mean) / deviation, limited: what the policy file's mean and variance make the robot compute
/// too.
inline float normalised(const InputScales& s, int i, float x) {
  return std::clamp((x - s.mean[i]) * s.inverse_deviation[i], -s.clip, s.clip);
}

}  // namespace sandrunner::train
