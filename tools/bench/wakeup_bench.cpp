// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <sstream>
#include <string>
#include <vector>

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

struct Wakeups {
  double p50_us = 0.0, p99_us = 0.0;
};

Wakeups ours(const ProcessConfig& config, PolicyRunner& policy) {
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
  const LogHistogram& late = end.report.control.late;
  return {1e-3 * static_cast<double>(late.quantile_ns(0.5)),
          1e-3 * static_cast<double>(late.quantile_ns(0.99))};
}

// cyclictest with a histogram of nanoseconds, one line a value: "value count". Values of a period
// and more are left out, as a slot missed is for us.
Wakeups cyclictest(int cpu) {
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
  std::vector<std::uint64_t> counts;
  std::uint64_t all = 0;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::uint64_t value = 0, count = 0;
    if (line.empty() || line[0] == '#') continue;
    if (std::sscanf(line.c_str(), "%lu %lu", &value, &count) != 2) continue;
    counts.resize(std::max(counts.size(), value + 1));
    counts[value] = count;
    all += count;
  }
  if (status != 0 || all == 0) {
    throw InputError(fmt::format("cyclictest (package rt-tests) gave no histogram: {}",
                                 text.substr(0, text.find('\n')).substr(0, 120)));
  }
  const auto quantile = [&](double share) {
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      seen += counts[i];
      if (static_cast<double>(seen) >= share * static_cast<double>(all)) {
        return 1e-3 * static_cast<double>(i);
      }
    }
    return 0.0;
  };
  return {quantile(0.5), quantile(0.99)};
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

  std::vector<double> p50, p99, our_p50, our_p99, their_p50, their_p99;
  for (int round = 0; round < rounds; ++round) {
    // They alternate in going first.
    Wakeups a, b;
    if (round % 2 == 0) a = ours(config, policy);
    b = cyclictest(cpu);
    if (round % 2 != 0) a = ours(config, policy);
    our_p50.push_back(a.p50_us);
    our_p99.push_back(a.p99_us);
    their_p50.push_back(b.p50_us);
    their_p99.push_back(b.p99_us);
    p50.push_back(a.p50_us / b.p50_us);
    p99.push_back(a.p99_us / b.p99_us);
  }
  report.facts.emplace_back(
      "wake-up",
      fmt::format("start of a 0.25 ms tick after its time, {} s each in turn, SCHED_FIFO "
                  "{} on CPU {}: control thread of a robot that walks on dry sand; "
                  "cyclictest of rt-tests",
                  kSample_s, kPriority, cpu));
  report.rates.emplace_back("control_thread_p50_us", quartiles(our_p50));
  report.rates.emplace_back("control_thread_p99_us", quartiles(our_p99));
  report.rates.emplace_back("cyclictest_p50_us", quartiles(their_p50));
  report.rates.emplace_back("cyclictest_p99_us", quartiles(their_p99));
  report.ratios.emplace_back("pd_p50_vs_cyclictest", quartiles(p50));
  report.ratios.emplace_back("pd_p99_vs_cyclictest", quartiles(p99));
}

}  // namespace sandrunner::bench
