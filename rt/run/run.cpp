// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/run.h"

#include <chrono>

#include "rt/loop/lockstep.h"
#include "rt/report/run_observer.h"
#include "sim/simulator.h"

namespace sandrunner {

RunResult run_lockstep(const ProcessConfig& config, Policy* policy, const CommandSource& command,
                       const RunPlan& plan, bool keep_record, const std::atomic<bool>& interrupt,
                       const std::function<void(const RunSample&)>& progress, const TickTap& tap) {
  sim::Simulator simulator(config.robot, config.simulator);
  if (!plan.start_walking) simulator.reset_lying();
  Lockstep loop(simulator, config.controller, plan.start_walking ? Mode::kWalk : Mode::kPassive,
                policy);
  RunScript script(command, plan, policy != nullptr);
  RunObserver observer(config, simulator, policy ? policy->spec().name : "", keep_record, progress);

  const auto start = std::chrono::steady_clock::now();
  TickRecord record;
  bool running = true;
  while (running) {
    record.has_truth = simulator.truth(record.truth) ? 1 : 0;
    record.before = {record.truth.joint_velocity_radps, record.truth.state};
    loop.tick(script.command(simulator.state().tick));
    TickFacts facts{.mode = loop.output().mode,
                    .faults = loop.output().faults,
                    .first_fault = loop.output().first_fault,
                    .interrupted = interrupt.load(std::memory_order_relaxed)};
    simulator.truth(record.truth);
    facts.base_contact = record.truth.base_contact != 0;
    facts.thigh_contact = record.truth.thigh_contact != 0;
    const OperatorVerdict verdict = script.advance(facts);
    running = verdict.running;
    record.input = loop.input();
    record.output = loop.output();
    record.counts = verdict.counts ? 1 : 0;
    record.counters = loop.controller().state().gate.counters;
    observer.add(record);
    if (tap) tap(record);
  }
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;

  RunResult result;
  take_outcome(script, result);
  result.simulated_s = static_cast<double>(simulator.state().tick) * kControlPeriod_s;
  result.realtime_factor = result.simulated_s / wall.count();
  StateHash hash;
  simulator.add_to(hash);
  loop.add_to(hash);
  result.state_hash = hash.value();
  result.figures = observer.figures();
  if (keep_record) result.record = observer.take_record();
  return result;
}

void take_outcome(const RunScript& script, RunResult& result) {
  result.survived = script.survived();
  if (!script.survived()) {
    result.fall_reason = script.fall_reason();
    result.fall_time_s = script.fall_time_s();
  }
  result.interrupted = script.interrupted();
  result.walked_s = script.walked_s();
}

}  // namespace sandrunner
