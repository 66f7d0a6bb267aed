// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "policy/policy_file.h"
#include "rt/base/errors.h"
#include "rt/realtime/realtime_run.h"
#include "rt/run/process_config.h"
#include "rt/run/run_script.h"
#include "sim/ground/terrain_description.h"
#include "tools/bench/benches.h"
#include "tools/bench/simulator_beside.h"
#include "tools/hil/controller_process.h"

namespace sandrunner::bench {
namespace {

constexpr double kWalk_s = 3.0;
constexpr int kTries = 4;
constexpr int kRobotPriority = 60;  // that of sandrunner-hil
constexpr const char* kTerrain = "dry-sand";
constexpr const char* kNetwork[] = {"hardware.unitree.interface=lo", "hardware.unitree.domain=75"};
constexpr Percentile kPercentiles[] = {{"p50", 0.5}, {"p99", 0.99}, {"p999", 0.999}};

/// `sandrunner-hil`, the program beside this one; killed with the object.
hil::ControllerProcess emulated_robot(const std::string& hardware) {
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe");
  std::vector<std::string> command = {self.parent_path() / "sandrunner-hil", "--hardware",
                                      hardware};
  for (const char* setting : kNetwork) command.insert(command.end(), {"--set", setting});
  return hil::ControllerProcess(command, ".", "/dev/null");
}

struct DidNotWalk : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Times of the whole tick. The robot stands up, walks and lies down. Throws DidNotWalk.
LogHistogram ticks_of(RobotIo& robot, const ProcessConfig& config, PolicyRunner& policy) {
  const CommandSource command("0.5,0,0");
  RunScript script(command, {.walk_s = kWalk_s}, true);
  SystemClock clock;
  const RealtimeEnd end = run_realtime(
      {.robot = robot, .controller = config.controller, .policy = policy, .op = script},
      config.realtime, clock);
  if (script.fall_reason() != nullptr) {
    throw DidNotWalk(fmt::format("the robot did not walk: {}", script.fall_reason()));
  }
  return end.report.control.busy;
}

/// A computer that was held up for some ms has stopped the robot: once more.
template <typename Run>
LogHistogram try_again(const Run& run) {
  for (int left = kTries; --left > 0;) {
    try {
      return run();
    } catch (const DidNotWalk&) {
    }
  }
  return run();
}

LogHistogram over_dds(const std::string& hardware, const ProcessConfig& config,
                      PolicyRunner& policy) {
  config.driver->fork_processes();
  const hil::ControllerProcess emulated = emulated_robot(hardware);
  const std::unique_ptr<RobotIo> robot = config.driver->connect();
  return ticks_of(*robot, config, policy);
}

LogHistogram without_dds(const ProcessConfig& config, PolicyRunner& policy) {
  SimulatorBeside robot(config.robot, config.simulator, kRobotPriority);
  return ticks_of(robot, config, policy);
}

}  // namespace

Report run_unitree_bench(const std::string& hardware, int rounds) {
  ConfigTree tree;
  sim::add_terrain_layer(tree, kTerrain);
  tree.add_file(hardware);
  const std::string kind = tree.text("hardware.kind", "can");
  if (kind != "unitree") {
    throw InputError(
        fmt::format("{}: hardware.kind: found '{}', expected 'unitree'", hardware, kind));
  }
  for (const char* setting : kNetwork) tree.set(setting);
  PolicyRunner policy(load_shipped_policy(shipped_policy_for(tree)));
  const ProcessConfig config = read_process_config(tree, policy.spec());
  Samples ticks_us;
  for (int round = 0; round < rounds; ++round) {
    // They take turns to go first.
    const auto run_with = [&] {
      add_percentiles(ticks_us, "tick_with_dds",
                      try_again([&] { return over_dds(hardware, config, policy); }), kPercentiles);
    };
    if (round % 2 == 0) run_with();
    add_percentiles(ticks_us, "tick_without_dds",
                    try_again([&] { return without_dds(config, policy); }), kPercentiles);
    if (round % 2 != 0) run_with();
  }
  Report report;
  report.facts.emplace_back(
      "tick",
      fmt::format("whole tick of the control thread of {} on {}: lies, stands up, walks "
                  "{} s at 0.5 m/s and lies down; with DDS: the robot is sandrunner-hil on "
                  "loopback; without: it is simulated in a thread beside the control thread",
                  config.robot.description.name, kTerrain, kWalk_s));
  for (const auto& [name, values] : ticks_us) report.rates.emplace_back(name, quartiles(values));
  for (const auto& [name, share] : kPercentiles) {
    add_ratio(report, fmt::format("tick_{}_with_vs_without_dds", name), ticks_us,
              fmt::format("tick_with_dds_{}_us", name),
              fmt::format("tick_without_dds_{}_us", name));
  }
  return report;
}

}  // namespace sandrunner::bench
