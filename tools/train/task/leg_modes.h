// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "policy/network_parameters.h"
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

/// to[kJointsPerLeg a + j] = sum over b of factor(a, b, j) from[kJointsPerLeg b + j], for each
/// column of a row-major matrix of kNumJoints rows. `from` and `to` do not overlap.
template <typename Factor>
void mix_legs(const Factor& factor, const float* from, std::size_t columns, float* to) {
  for (std::size_t a = 0; a < kNumLegs; ++a) {
    for (std::size_t joint = 0; joint < kJointsPerLeg; ++joint) {
      float* const row = to + (kJointsPerLeg * a + joint) * columns;
      for (std::size_t c = 0; c < columns; ++c) row[c] = 0.0f;
      for (std::size_t b = 0; b < kNumLegs; ++b) {
        const auto share = static_cast<float>(factor(a, b, joint));
        const float* const other = from + (kJointsPerLeg * b + joint) * columns;
        for (std::size_t c = 0; c < columns; ++c) row[c] += share * other[c];
      }
    }
  }
}

/// Joints from modes, for each column of a row-major matrix of kNumJoints rows: an action, or the
/// network's last layer, which the policy file holds in joints. `gain`: of HFE and KFE in each
/// mode; HAA has gain 1. `modes` and `joints` do not overlap.
inline void joints_from_modes(const std::array<double, kNumLegs>& gain, const float* modes,
                              std::size_t columns, float* joints) {
  const auto factor = [&](std::size_t leg, std::size_t mode, std::size_t joint) {
    return kLegModes[leg][mode] * (joint == 0 ? 1.0 : gain[mode]);
  };
  mix_legs(factor, modes, columns, joints);
}

/// The way back: what a network in modes has to answer for these joints.
inline void modes_from_joints(const std::array<double, kNumLegs>& gain, const float* joints,
                              std::size_t columns, float* modes) {
  const auto factor = [&](std::size_t mode, std::size_t leg, std::size_t joint) {
    return kLegModes[leg][mode] / (joint == 0 ? 1.0 : gain[mode]);
  };
  mix_legs(factor, joints, columns, modes);
}

/// Turns a network that answers in modes into one that answers in joints.
inline void answer_in_joints(const std::array<double, kNumLegs>& gain,
                             NetworkParameters& parameters) {
  DenseParameters& last = parameters.actor.back();
  for (std::vector<float>* rows : {&last.weight, &last.bias}) {
    const std::vector<float> modes = *rows;
    joints_from_modes(gain, modes.data(), modes.size() / kNumJoints, rows->data());
  }
}

/// The way back.
inline void answer_in_modes(const std::array<double, kNumLegs>& gain,
                            NetworkParameters& parameters) {
  DenseParameters& last = parameters.actor.back();
  for (std::vector<float>* rows : {&last.weight, &last.bias}) {
    const std::vector<float> joints = *rows;
    modes_from_joints(gain, joints.data(), joints.size() / kNumJoints, rows->data());
  }
}

}  // namespace sandrunner::train
