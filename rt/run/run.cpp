// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/run.h"

#include "rt/run/run_script.h"

namespace sandrunner {
namespace {

// `loop(rig, result)` runs the rig and enters how it ended.
template <typename Loop>
RunResult run(const Rig& rig, const RunRows& rows, const Loop& loop) {
  RunObserver observer(rows.scene, rows.sinks);
  Rig observed = rig;
  // Rows first: a live view that ends has all of them.
  observed.sinks.insert(observed.sinks.begin(), &observer);
  RunResult result;
  loop(observed, result);
  const Fault fault = result.end.gate.first_fault;
  result.survived = fault == Fault::kNone;  // no fault since the start, even if it was reset
  if (!result.survived) result.fall_reason = fault_name(fault);
  result.interrupted = rig.interrupts > 0;
  result.walked_s = static_cast<double>(observer.counted_ticks()) * kControlPeriod_s;
  result.record = observer.take_record();
  result.has_truth = result.record.rows.empty() || result.record.has_truth();
  result.figures = run_figures(result.record);
  return result;
}

}  // namespace

void RunScript::report(RunResult& result) const {
  result.survived = survived();
  result.fall_reason = survived() ? "" : fall_reason_;
  if (!survived()) {
    result.fall_time_s = fall_time_s_;
    result.fall_mode = fall_mode_;
  }
  result.interrupted = interrupted_;
  result.walked_s = walked_s();
}

RunResult run_in_lockstep(const Rig& rig, const RunRows& rows) {
  return run(rig, rows,
             [](const Rig& observed, RunResult& result) { result.end = run_lockstep(observed); });
}

RunResult run_in_realtime(const Rig& rig, const RunRows& rows, const RealtimeConfig& realtime,
                          Clock& clock) {
  return run(rig, rows, [&](const Rig& observed, RunResult& result) {
    const RealtimeEnd end = run_realtime(observed, realtime, clock);
    result.end = end;
    result.realtime = end.report;
  });
}

}  // namespace sandrunner
