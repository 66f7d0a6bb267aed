// SPDX-License-Identifier: BSD-3-Clause
// What several tests of the program need: settings, policies, a check of refusals.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "core/printing.h"
#include "policy/policy_file.h"
#include "rt/run/process_config.h"
#include "rt/run/run.h"
#include "rt/run/run_script.h"
#include "rt/run/scene.h"
#include "sim/simulator.h"
#include "tests/policy/random_policy.h"
#include "tests/support/error_of.h"

namespace sandrunner {

/// Settings as the program makes them from --terrain and --set.
inline ProcessConfig config_of(const std::string& terrain,
                               const std::vector<std::string>& assignments = {},
                               const PolicySpec* spec = nullptr) {
  ConfigTree tree;
  sim::add_terrain_layer(tree, terrain);
  for (const std::string& assignment : assignments) tree.set(assignment);
  return read_process_config(tree, spec);
}

/// A policy that runs, not one that walks.
inline Policy random_policy(std::uint64_t seed = 1) {
  const PolicyFile file = random_policy_file(seed);
  return {file.spec, Network(file.parameters)};
}

/// The last row of a run in Stand before it lies down, which takes 1.5 s.
inline RunRow last_standing(const RunRecord& record) {
  const auto last = std::find_if(record.rows.rbegin(), record.rows.rend(),
                                 [](const RunRow& row) { return mode_of(row) == Mode::kStand; });
  if (record.rows.rend() - last <= 151) {
    ADD_FAILURE() << "never stood";
    return record.rows.back();
  }
  return *(last + 151);
}

/// Calls functions of a test; those that are unset are left out.
struct CallingSink final : TickSink, RowSink {
  std::function<void(std::int64_t start_ns)> at_begin = {};
  std::function<void(const TickRecord& tick)> at_tick = {};
  std::function<void(const RunRow& row)> at_row = {};

  void begin(std::int64_t start_ns) override {
    if (at_begin) at_begin(start_ns);
  }
  void add(const TickRecord& tick) override {
    if (at_tick) at_tick(tick);
  }
  void add(const RunRow& row, std::span<const Footprint>) override {
    if (at_row) at_row(row);
  }
};

/// A run of the simulated robot.
struct SimulatedRun {
  const ProcessConfig& config;
  PolicyRunner policy = {};
  std::string command = "1,0,0";
  RunPlan plan = {};
  const std::atomic<int>* interrupts = &kNoInterrupts;
  std::function<void(const RunRow& row)> at_row = {};
  std::function<void(const TickRecord& tick)> at_tick = {};
  std::function<void(std::int64_t start_ns)> at_begin = {};
  OperatorInput* live = nullptr;
  bool realtime = false;
  Clock* clock = nullptr;  ///< null: the system's
};

inline RunResult simulate(const SimulatedRun& run) {
  sim::Simulator simulator(run.config.robot, run.config.simulator);
  if (!run.plan.start_walking) simulator.reset_lying();
  const CommandSource command(run.command);
  CallingSink sink;
  sink.at_begin = run.at_begin;
  sink.at_tick = run.at_tick;
  sink.at_row = run.at_row;
  PolicyRunner policy = run.policy;
  RunScript script(command, run.plan, !run.policy.is_none() && !run.config.controller.gate.hanging);
  const Rig rig{.robot = simulator,
                .controller = run.config.controller,
                .start = run.plan.start_walking ? Mode::kWalk : Mode::kPassive,
                .policy = policy,
                .op = run.live ? *run.live : script,
                .sinks = {&sink},
                .interrupts = *run.interrupts};
  const RunRows rows{.scene = scene_of(run.config, policy.name()), .sinks = {&sink}};
  SystemClock system;
  RunResult result = run.realtime ? run_in_realtime(rig, rows, run.config.realtime,
                                                    run.clock ? *run.clock : system)
                                  : run_in_lockstep(rig, rows);
  if (!run.live) script.report(result);
  return result;
}

/// In lockstep under "1,0,0", uninterrupted.
inline RunResult run_once(const ProcessConfig& config, const PolicyRunner& policy,
                          const RunPlan& plan) {
  return simulate({.config = config, .policy = policy, .plan = plan});
}

/// Checks that `action` is refused in one line that has all of `parts`.
template <typename Action>
void expect_refused(const Action& action, const std::vector<std::string>& parts) {
  const std::string what = error_of(action);
  EXPECT_NE(what, "") << "not refused; expected an error with '" << parts.front() << "'";
  for (const std::string& part : parts) {
    EXPECT_NE(what.find(part), std::string::npos) << "no '" << part << "' in: " << what;
  }
}

}  // namespace sandrunner
