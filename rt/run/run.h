// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "rt/loop/rig.h"
#include "rt/realtime/realtime_run.h"
#include "rt/report/run_observer.h"
#include "rt/report/run_result.h"

namespace sandrunner {

/// Who watches the rows of a run, and what they need to know of its robot and ground.
struct RunRows {
  RunScene scene = {};
  std::vector<RowSink*> sinks = {};
};

/// Runs the rig in one thread, as fast as it goes. The result has the rows and figures; it calls
/// every fault a fall, and knows of no other: RunScript::report knows more.
RunResult run_in_lockstep(const Rig& rig, const RunRows& rows);

/// The same run in real time. Throws InputError if a required part of the set-up is missing.
RunResult run_in_realtime(const Rig& rig, const RunRows& rows, const RealtimeConfig& realtime,
                          Clock& clock);

}  // namespace sandrunner
