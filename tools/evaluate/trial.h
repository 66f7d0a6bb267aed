// SPDX-License-Identifier: BSD-3-Clause
// One run of one robot: where it starts, on what, under which command and disturbances.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "rt/core/messages.h"
#include "sim/batch/sensors.h"
#include "sim/step/robot_step.h"

namespace sandrunner::evaluate {

/// Zero, then a linear rise to the target: the larger of |v_xy| (m/s) and |yaw rate| (rad/s) rises
/// by `acceleration` per second.
struct CommandScript {
  VelocityCommand target;
  double hold_s = 0.5;
  double acceleration = 2.0;  ///< infinite: a step

  VelocityCommand at(double t_s) const noexcept {
    if (t_s < hold_s) return {};
    const double size =
        std::max(std::sqrt(target.vx_mps * target.vx_mps + target.vy_mps * target.vy_mps),
                 std::fabs(target.wz_radps));
    const double way = acceleration * (t_s - hold_s);
    // Not less, so that infinity times 0 is a step too.
    const double share = size > 0.0 && way < size ? way / size : 1.0;
    return {share * target.vx_mps, share * target.vy_mps, share * target.wz_radps};
  }
};

/// A loose patch under one foot: the first stance of this leg beyond a distance stands on patch 1
/// of the terrain. The foot is moved there within 10 ms of its touchdown.
struct LooseStep {
  double from_m = 0.0;  ///< 0: none
  int leg = 0;
};

struct Trial {
  const sim::Terrain<float>* terrain = nullptr;
  const sim::RobotState<float>* start = nullptr;
  CommandScript command;
  /// The run ends after this time, or, if there is a track, when its end is reached, but not
  /// before this time and not after `longest_s`.
  double duration_s = 10.0;
  double longest_s = 30.0;
  /// Distances from the start, m, along the robot's own heading; equal: no track.
  double track_begin_m = 0.0, track_end_m = 0.0;
  int latency_ticks = 1;  ///< age of the observation at which joint targets arrive, 1 to 80
  sim::SensorErrors sensors;
  double noise_scale = 0.0;     ///< of sim::ObservationNoise
  double push_speed_mps = 0.0;  ///< kick of this size in a random direction every second
  LooseStep loose_step;
  double ground_changes_at_m = 0.0;  ///< world x of the terrain's second patch; 0: none to be met
  std::uint64_t seed = 0;            ///< of noise and pushes

  /// Whether there is a place where the robot is disturbed, which it may never reach.
  bool has_place() const noexcept { return loose_step.from_m > 0.0 || ground_changes_at_m > 0.0; }
  /// Whether joint targets arrive a policy step late, besides what is left of the delay.
  bool a_step_late() const noexcept { return latency_ticks > kTicksPerPolicyStep; }
  bool has_track() const noexcept { return track_end_m > track_begin_m; }
};

}  // namespace sandrunner::evaluate
