// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <vector>

#include "policy/policy.h"
#include "rt/realtime/clock.h"
#include "rt/report/run_observer.h"
#include "rt/report/run_result.h"
#include "rt/run/command_source.h"
#include "rt/run/run_script.h"

namespace sandrunner {

/// What a run is made of; all of it outlives the run.
struct RunParts {
  RobotIo& robot;
  const ControllerConfig& controller;
  Policy* policy = nullptr;  ///< null: the robot only stands up, and is let down
  const CommandSource& command;
  RunPlan plan = {};
  /// Operator in place of the script that `command` and `plan` make; null: that script.
  OperatorInput* live = nullptr;
  RunScene scene = {};
  std::vector<RowSink*> row_sinks = {};  ///< live view
  std::vector<TickSink*> sinks = {};     ///< recorders, telemetry, progress
  BetweenTicks* between = nullptr;       ///< of a run in lockstep; may be null
  /// How often somebody has wanted it to end: at the first time it ends gently, at the second in
  /// damping at once.
  const std::atomic<int>& interrupts;
};

/// Runs the robot in one thread, as fast as it goes: from lying to standing, the walk, standing
/// again and being let down (or just the walk).
RunResult run_in_lockstep(const RunParts& parts);

/// The same run in real time. Throws InputError if a required part of the set-up is not to be had.
RunResult run_in_realtime(const RunParts& parts, const RealtimeConfig& realtime, Clock& clock);

}  // namespace sandrunner
