// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <sstream>
#include <string>

#include "policy/policy_file.h"
#include "rt/base/errors.h"
#include "rt/realtime/realtime_run.h"
#include "rt/run/process_config.h"
#include "rt/run/run_script.h"
#include "sim/ground/terrain_description.h"
#include "sim/simulator.h"
#include "tools/bench/benches.h"

namespace sandrunner::bench {
namespace {

constexpr int kSample_s = 5;
constexpr int kPriority = 80;
constexpr int kPeriod_us = 1'000'000 / kControlHz;

constexpr Percentile kPercentiles[] = {{"p50", 0.5}, {"p99", 0.99}};

// How late the ticks start, as cyclictest() has it.
LogHistogram ours(const ProcessConfig& config, PolicyRunner& policy) {
  sim::Simulator simulator(config.robot, config.simulator);
  const CommandSource command("1,0,0");
  RunScript script(command, {.walk_s = kSample_s, .start_walking = true}, true);
  SystemClock clock;
  const RealtimeEnd end = run_realtime({.robot = simulator,
                                        .controller = config.controller,
                                        .start = Mode::kWalk,
                                        .policy = policy,
                                        .op = script},
                                       config.realtime, clock);
  return end.report.control.late;
}

// cyclictest with a histogram of nanoseconds, one line a value: "value count". Values of a period
// and more are left out, as a slot missed is for us.
LogHistogram cyclictest(int cpu) {
  const std::string command = fmt::format(
      "cyclictest --mlockall --threads=1 --affinity={} --priority={} --interval={} --duration={}s "
      "--quiet --nsecs --histogram={} 2>&1",
      cpu, kPriority, kPeriod_us, kSample_s, 1000 * kPeriod_us);
  FILE* const pipe = popen(command.c_str(), "r");
  std::string text;
  std::array<char, 65536> part;
  for (std::size_t n; pipe && (n = fread(part.data(), 1, part.size(), pipe)) > 0;) {
    text.append(part.data(), n);
  }
  const int status = pipe ? pclose(pipe) : -1;
  LogHistogram late;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    long value_ns = 0, count = 0;
    if (std::sscanf(line.c_str(), "%ld %ld", &value_ns, &count) != 2) continue;
    for (; count > 0; --count) late.add(value_ns);
  }
  if (status != 0 || late.count() == 0) {
    throw InputError(fmt::format("cyclictest (package rt-tests) gave no histogram: {}",
                                 text.substr(0, text.find('\n')).substr(0, 120)));
  }
  return late;
}

}  // namespace

void run_wakeup_bench(int rounds, Report& report) {
  PolicyRunner policy(load_shipped_policy());
  ConfigTree tree;
  sim::add_terrain_layer(tree, "dry-sand");
  ProcessConfig config = read_process_config(tree, policy.spec());
  const int cpu = allowed_cpus().back();
  config.realtime.control_cpu = cpu;
  config.realtime.control_priority = kPriority;

  Samples late_us;
  for (int round = 0; round < rounds; ++round) {
    // They alternate in going first.
    const auto run_ours = [&] {
      add_percentiles(late_us, "control_thread", ours(config, policy), kPercentiles);
    };
    if (round % 2 == 0) run_ours();
    add_percentiles(late_us, "cyclictest", cyclictest(cpu), kPercentiles);
    if (round % 2 != 0) run_ours();
  }
  report.facts.emplace_back(
      "wake-up",
      fmt::format("start of a 0.25 ms tick after its time, {} s each in turn, SCHED_FIFO "
                  "{} on CPU {}: control thread of a robot that walks on dry sand; "
                  "cyclictest of rt-tests",
                  kSample_s, kPriority, cpu));
  for (const auto& [name, values] : late_us) report.rates.emplace_back(name, quartiles(values));
  for (const auto& [name, share] : kPercentiles) {
    add_ratio(report, fmt::format("pd_{}_vs_cyclictest", name), late_us,
              fmt::format("control_thread_{}_us", name), fmt::format("cyclictest_{}_us", name));
  }
}

}  // namespace sandrunner::bench
