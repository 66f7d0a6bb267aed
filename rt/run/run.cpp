// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/run.h"

namespace sandrunner {
namespace {

// A run but for its loop: `loop(start, op, sinks, result)` runs that.
template <typename Loop>
RunResult run(const RunParts& parts, const Loop& loop) {
  RunScript script(parts.command, parts.plan,
                   parts.policy != nullptr && !parts.controller.gate.hanging);
  RunObserver observer(parts.scene, parts.row_sinks);
  // Rows first: a live view that ends has all of them.
  std::vector<TickSink*> sinks = {&observer};
  sinks.insert(sinks.end(), parts.sinks.begin(), parts.sinks.end());
  RunResult result;
  OperatorInput& op = parts.live ? *parts.live : script;
  loop(parts.plan.start_walking ? Mode::kWalk : Mode::kPassive, op, sinks, result);
  if (parts.live) {
    result.interrupted = parts.interrupts > 0;
    const Fault fault = result.end.gate.first_fault;
    result.survived = fault == Fault::kNone;  // no fault since, whoever has reset it
    if (!result.survived) result.fall_reason = fault_name(fault);
    result.walked_s = static_cast<double>(observer.counted_ticks()) * kControlPeriod_s;
  } else {
    result.survived = script.survived();
    if (!result.survived) {
      result.fall_reason = script.fall_reason();
      result.fall_time_s = script.fall_time_s();
      result.fall_mode = script.fall_mode();
    }
    result.interrupted = script.interrupted();
    result.walked_s = script.walked_s();
  }
  result.record = observer.take_record();
  result.has_truth = result.record.rows.empty() || result.record.has_truth();
  result.figures = run_figures(result.record);
  return result;
}

}  // namespace

RunResult run_in_lockstep(const RunParts& parts) {
  return run(parts, [&](Mode start, OperatorInput& op, TickSinks sinks, RunResult& result) {
    result.end = run_lockstep(parts.robot, parts.controller, start, parts.policy, op,
                              parts.interrupts, sinks, parts.between);
  });
}

RunResult run_in_realtime(const RunParts& parts, const RealtimeConfig& realtime, Clock& clock) {
  return run(parts, [&](Mode start, OperatorInput& op, TickSinks sinks, RunResult& result) {
    const RealtimeEnd end = run_realtime(parts.robot, parts.controller, realtime, start,
                                         parts.policy, op, parts.interrupts, sinks, clock);
    result.end = end;
    result.realtime = end.report;
  });
}

}  // namespace sandrunner
