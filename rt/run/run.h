// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "policy/policy.h"
#include "rt/realtime/policy_thread.h"
#include "rt/realtime/setup.h"
#include "rt/report/run_record.h"
#include "rt/report/run_statistics.h"
#include "rt/run/command_source.h"
#include "rt/run/process_config.h"
#include "rt/run/run_script.h"

namespace sandrunner {

/// How the threads of a real-time run kept their times.
struct RealtimeReport {
  ControlDeadlines control;
  PolicyDeadlines policy;
  std::uint64_t late_policy_outputs = 0;  ///< that came after the tick they were meant for
  std::uint64_t records_dropped = 0;      ///< ticks that figures and record lack
  std::vector<SetupItem> setup;
};

struct RunResult {
  bool survived =
      true;  ///< on its feet: no base or thigh contact since the first Walk, no latched fault
  std::optional<double> fall_time_s;  ///< since the start of Walk
  std::string
      fall_reason;  ///< "base_contact", "thigh_contact", "did_not_stand", or the name of a fault
  bool interrupted = false;
  double walked_s = 0.0;  ///< time in Walk under the command
  double simulated_s = 0.0;
  double realtime_factor = 0.0;  ///< simulated time over wall time of the loop
  std::uint64_t state_hash = 0;  ///< of simulator, controller and policy at the end
  RunFigures figures;
  RunRecord record;  ///< filled only if asked for
  std::optional<RealtimeReport> realtime;
};

/// Copies what the script knows about the end of the run.
void take_outcome(const RunScript& script, RunResult& result);

/// Gets every tick of a run, in an ordinary thread: recorders and telemetry.
using TickTap = std::function<void(const TickRecord&)>;

/// Runs the simulated robot in lockstep: from lying to standing, the walk, and standing again (or
/// just the walk). Without a policy it only stands up. `interrupt` ends it in damping; `progress`
/// is called every half second of simulated time.
RunResult run_lockstep(const ProcessConfig& config, Policy* policy, const CommandSource& command,
                       const RunPlan& plan, bool keep_record, const std::atomic<bool>& interrupt,
                       const std::function<void(const RunSample&)>& progress,
                       const TickTap& tap = {});

/// Extras of a real-time run, for tests.
struct RealtimeHooks {
  LoopHooks control, policy;
  /// Called every few milliseconds from the calling thread while the loops run.
  std::function<void(PolicyThread&)> meanwhile;
  OperatorInput* op = nullptr;  ///< in place of the script of `plan`
};

/// The same run in real time: control and policy in threads of their own, the caller's thread turns
/// their ticks into figures. Throws InputError if a required part of the set-up is not to be had.
RunResult run_realtime(const ProcessConfig& config, Policy* policy, const CommandSource& command,
                       const RunPlan& plan, bool keep_record, const std::atomic<bool>& interrupt,
                       const std::function<void(const RunSample&)>& progress,
                       const TickTap& tap = {}, const RealtimeHooks& hooks = {});

}  // namespace sandrunner
