// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "rt/core/controller.h"
#include "rt/core/robot_io.h"
#include "rt/loop/operator_input.h"
#include "rt/loop/policy_runner.h"
#include "rt/loop/tick_sink.h"

namespace sandrunner {

/// What an act between two ticks did to the robot.
enum class RobotNow : std::uint8_t { kAsBefore, kChanged };

/// What happens between two ticks of a run in lockstep, in the thread of the ticks.
class BetweenTicks {
 public:
  virtual ~BetweenTicks() = default;
  /// Before tick `next`; what it does is noted in `sinks`.
  virtual RobotNow act(std::uint64_t next, TickSinks sinks) = 0;
};

/// Nothing wants the run to end.
inline const std::atomic<int> kNoInterrupts{0};

/// A run, assembled: run_lockstep and run_realtime take it. All parts outlive the run.
struct Rig {
  RobotIo& robot;
  const ControllerConfig& controller;
  Mode start = Mode::kPassive;  ///< of the controller
  PolicyRunner& policy;
  OperatorInput& op;  ///< commands the robot and ends the run
  std::vector<TickSink*> sinks = {};
  BetweenTicks* between = nullptr;  ///< in lockstep only; null: nothing
  /// How often the end of the run was requested: at the first time the operator ends it gently, at
  /// the second in damping at once.
  const std::atomic<int>& interrupts = kNoInterrupts;
};

}  // namespace sandrunner
