// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <vector>

#include "policy/policy_file.h"
#include "rt/base/errors.h"
#include "rt/realtime/realtime_run.h"
#include "rt/run/process_config.h"
#include "rt/run/run_script.h"
#include "sim/ground/terrain_description.h"
#include "tools/bench/benches.h"
#include "tools/bench/simulator_beside.h"

namespace sandrunner::bench {
namespace {

constexpr double kWalk_s = 3.0;
constexpr int kTries = 4;
constexpr int kRobotPriority = 60;  // that of sandrunner-hil
constexpr const char* kTerrain = "dry-sand";
constexpr const char* kNetwork[] = {"hardware.unitree.interface=lo", "hardware.unitree.domain=75"};
constexpr std::array kShares = {0.5, 0.99, 0.999};
constexpr std::array kNames = {"p50", "p99", "p999"};
/// Of the whole tick, at kShares, us.
using TickTimes = std::array<double, kShares.size()>;

/// `sandrunner-hil`, the program beside this one; killed with this object.
class EmulatedRobot {
 public:
  explicit EmulatedRobot(const std::string& hardware) {
    const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe");
    const std::string program = self.parent_path() / "sandrunner-hil";
    std::vector<const char*> words = {program.c_str(), "--hardware", hardware.c_str()};
    for (const char* setting : kNetwork) words.insert(words.end(), {"--set", setting});
    words.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
    const int error = posix_spawn(&pid_, program.c_str(), &files, nullptr,
                                  const_cast<char**>(words.data()), environ);
    posix_spawn_file_actions_destroy(&files);
    if (error != 0) throw InputError(fmt::format("{}: {}", program, std::strerror(error)));
  }
  ~EmulatedRobot() {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  EmulatedRobot(const EmulatedRobot&) = delete;
  EmulatedRobot& operator=(const EmulatedRobot&) = delete;

 private:
  pid_t pid_ = 0;
};

struct DidNotWalk : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Stands up, walks and lies down. Throws DidNotWalk.
TickTimes ticks_of(RobotIo& robot, const ProcessConfig& config, PolicyRunner& policy) {
  const CommandSource command("0.5,0,0");
  RunScript script(command, {.walk_s = kWalk_s}, true);
  SystemClock clock;
  const RealtimeEnd end = run_realtime(
      {.robot = robot, .controller = config.controller, .policy = policy, .op = script},
      config.realtime, clock);
  if (script.fall_reason() != nullptr) {
    throw DidNotWalk(fmt::format("the robot did not walk: {}", script.fall_reason()));
  }
  TickTimes ticks_us;
  for (std::size_t i = 0; i < kShares.size(); ++i) {
    ticks_us[i] = 1e-3 * static_cast<double>(end.report.control.busy.quantile_ns(kShares[i]));
  }
  return ticks_us;
}

/// A computer that was held up for some ms has stopped the robot: once more.
template <typename Run>
TickTimes try_again(const Run& run) {
  for (int left = kTries; --left > 0;) {
    try {
      return run();
    } catch (const DidNotWalk&) {
    }
  }
  return run();
}

TickTimes over_dds(const std::string& hardware, const ProcessConfig& config, PolicyRunner& policy) {
  config.driver->fork_processes();
  const EmulatedRobot emulated(hardware);
  const std::unique_ptr<RobotIo> robot = config.driver->connect();
  return ticks_of(*robot, config, policy);
}

TickTimes without_dds(const ProcessConfig& config, PolicyRunner& policy) {
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
  std::array<std::vector<double>, kShares.size()> with_us, without_us, ratio;
  for (int round = 0; round < rounds; ++round) {
    // They take turns to go first.
    TickTimes with, without;
    const auto run_with = [&] {
      with = try_again([&] { return over_dds(hardware, config, policy); });
    };
    if (round % 2 == 0) run_with();
    without = try_again([&] { return without_dds(config, policy); });
    if (round % 2 != 0) run_with();
    for (std::size_t i = 0; i < kShares.size(); ++i) {
      with_us[i].push_back(with[i]);
      without_us[i].push_back(without[i]);
      ratio[i].push_back(with[i] / without[i]);
    }
  }
  Report report;
  report.facts.emplace_back(
      "tick",
      fmt::format("whole tick of the control thread of {} on {}: lies, stands up, walks "
                  "{} s at 0.5 m/s and lies down; with DDS: the robot is sandrunner-hil on "
                  "loopback; without: it is simulated in a thread beside the control thread",
                  config.robot.description.name, kTerrain, kWalk_s));
  for (std::size_t i = 0; i < kShares.size(); ++i) {
    report.rates.emplace_back(fmt::format("tick_with_dds_{}_us", kNames[i]), quartiles(with_us[i]));
    report.rates.emplace_back(fmt::format("tick_without_dds_{}_us", kNames[i]),
                              quartiles(without_us[i]));
    report.ratios.emplace_back(fmt::format("tick_{}_with_vs_without_dds", kNames[i]),
                               quartiles(ratio[i]));
  }
  return report;
}

}  // namespace sandrunner::bench
