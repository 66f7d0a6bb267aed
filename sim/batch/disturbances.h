// SPDX-License-Identifier: BSD-3-Clause
// What disturbs a robot of a batch between two policy steps: one model for trainings and
// evaluations, which decide when. A delay of joint targets is BatchDrive::switch_tick.
#pragma once

#include <array>
#include <utility>

#include "sim/step/robot_step.h"

namespace sandrunner::sim {

/// A kick: a change of the base's horizontal velocity, m/s.
inline void push(RobotState<float>& state, double vx_mps, double vy_mps) {
  state.rigid.velocity.x += static_cast<float>(vx_mps);
  state.rigid.velocity.y += static_cast<float>(vy_mps);
}

/// Detects touchdowns, for ground that is looser under one foot alone. Patches along x would loosen
/// it under both feet of a pair.
struct TouchdownWatch {
  std::array<bool, kNumLegs> in_air{};  ///< when last looked

  /// Whether the foot has touched down since the last call for this leg.
  bool touched_down(const RobotState<float>& state, int leg) {
    bool touches = false;
    for (int patch = 0; patch < kMaxFootPatches; ++patch) {
      touches = touches || state.contact(leg, patch).active != 0.0f;
    }
    return std::exchange(in_air[leg], !touches) && touches;
  }
};

/// Puts a foot on another patch of the terrain until it lifts off.
inline void put_on_patch(RobotState<float>& state, int leg, int patch) {
  for (int part = 0; part < kMaxFootPatches; ++part) {
    state.contact(leg, part).region = static_cast<float>(patch);
  }
}

}  // namespace sandrunner::sim
