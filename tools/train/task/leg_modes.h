// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

#include "rt/core/messages.h"

namespace sandrunner::train {

/// The coordinates in which the network answers while it is trained: its output 3 m + j moves joint
/// j of all legs in mode m; row: leg, column: mode (pronk, bound, pace, trot). Orthogonal. The
/// action's noise is alike in all outputs, so a gain on a mode decides how far it is explored and
/// how fast it is learnt.
inline constexpr std::array<std::array<float, kNumLegs>, kNumLegs> kLegModes = {{
    {0.5f, 0.5f, 0.5f, 0.5f},
    {0.5f, 0.5f, -0.5f, -0.5f},
    {0.5f, -0.5f, 0.5f, -0.5f},
    {0.5f, -0.5f, -0.5f, 0.5f},
}};

/// Joints from modes, for each column of a row-major matrix of kNumJoints rows: an action, or the
/// network's last layer, which the policy file holds in joints. `gain`: of HFE and KFE in each
/// mode; HAA has gain 1. `modes` and `joints` do not overlap.
inline void joints_from_modes(const std::array<double, kNumLegs>& gain, const float* modes,
                              std::size_t columns, float* joints) {
  for (std::size_t leg = 0; leg < kNumLegs; ++leg) {
    for (std::size_t joint = 0; joint < kJointsPerLeg; ++joint) {
      float* const row = joints + (kJointsPerLeg * leg + joint) * columns;
      for (std::size_t c = 0; c < columns; ++c) row[c] = 0.0f;
      for (std::size_t mode = 0; mode < kNumLegs; ++mode) {
        const auto factor =
            static_cast<float>(kLegModes[leg][mode] * (joint == 0 ? 1.0 : gain[mode]));
        const float* const from = modes + (kJointsPerLeg * mode + joint) * columns;
        for (std::size_t c = 0; c < columns; ++c) row[c] += factor * from[c];
      }
    }
  }
}

/// The way back: what a network in modes has to answer for these joints.
inline void modes_from_joints(const std::array<double, kNumLegs>& gain, const float* joints,
                              std::size_t columns, float* modes) {
  for (std::size_t mode = 0; mode < kNumLegs; ++mode) {
    for (std::size_t joint = 0; joint < kJointsPerLeg; ++joint) {
      float* const row = modes + (kJointsPerLeg * mode + joint) * columns;
      for (std::size_t c = 0; c < columns; ++c) row[c] = 0.0f;
      for (std::size_t leg = 0; leg < kNumLegs; ++leg) {
        const auto factor =
            static_cast<float>(kLegModes[leg][mode] / (joint == 0 ? 1.0 : gain[mode]));
        const float* const from = joints + (kJointsPerLeg * leg + joint) * columns;
        for (std::size_t c = 0; c < columns; ++c) row[c] += factor * from[c];
      }
    }
  }
}

}  // namespace sandrunner::train
