// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <type_traits>

#include "rt/core/controller.h"
#include "rt/core/robot_truth.h"

namespace sandrunner {

/// How long the parts of a tick took; all zero in lockstep.
struct TickTiming {
  std::int64_t late_ns = 0;     ///< start after the slot's time
  std::int64_t read_ns = 0;     ///< RobotIo::read
  std::int64_t control_ns = 0;  ///< Controller::step and the exchange with the policy
  std::int64_t write_ns = 0;    ///< RobotIo::write: the bus, or the simulator's step
};

/// What the tick began with, where the robot offers its truth.
struct TruthBefore {
  JointArray<double> joint_velocity_radps{};
  StateEstimate state;  ///< what the estimate of this tick's sensors should be
};

/// One control tick as it is handed to ordinary threads: inputs and outputs of the step functions
/// complete, so that it can be replayed.
struct TickRecord {
  ControllerInput input;
  ControllerOutput output;
  GateCounters counters;      ///< after the tick
  std::uint64_t counts = 0;   ///< 1: belongs to the walk that the figures are taken over
  std::uint64_t skipped = 0;  ///< slots missed directly before it
  TickTiming timing;
  std::uint64_t has_truth = 0;  ///< 1: the robot offers its truth; else the rest is zero
  TruthBefore before;
  RobotTruth truth;  ///< after the tick
};
static_assert(std::is_trivially_copyable_v<TickRecord>);

}  // namespace sandrunner
