// SPDX-License-Identifier: BSD-3-Clause
// sandrunner-hil: the simulated robot at the other end of the controller's buses, or of its DDS
// topics.
#include <fmt/format.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rt/base/command_line.h"
#include "rt/base/errors.h"
#include "rt/base/output_files.h"
#include "rt/base/program.h"
#include "rt/base/standard_error.h"
#include "rt/core/processor.h"
#include "tools/hil/bench.h"
#include "tools/hil/bench_config.h"
#include "tools/hil/run_fault.h"

namespace sandrunner::hil {
namespace {

volatile std::sig_atomic_t interrupted = 0;

// Below the threads of the controller, where both share a processor: it is measured, not the bench.
constexpr int kPriority = 60;

void become_real_time() {
  const sched_param priority{.sched_priority = kPriority};
  if (sched_setscheduler(0, SCHED_FIFO, &priority) != 0) {
    to_standard_error(fmt::format(
        "sandrunner-hil: no real-time priority ({}): answers may be late\n", strerror(errno)));
  }
  mlockall(MCL_CURRENT | MCL_FUTURE);
}

struct Arguments {
  std::string hardware, terrain = "dry-sand", imu, out;
  std::vector<std::string> config_files, assignments, faults, only;
  double walk_s = 0.0;
  bool list_faults = false;
  RunPlace can, unitree;
  double unitree_mps = 1.0;
};

int play(const Arguments& a) {
  const ProcessConfig config =
      read_bench_config(a.hardware, a.terrain, a.config_files, a.assignments);
  std::signal(SIGINT, [](int) { interrupted = 1; });
  std::signal(SIGTERM, [](int) { interrupted = 1; });
  std::vector<TimedFault> faults = read_faults(config, a.faults);
  // First: the threads of DDS take the priority over, or a busy computer loses commands.
  become_real_time();
  Bench bench(config, a.imu, std::move(faults), a.walk_s);
  to_standard_error(fmt::format("sandrunner-hil: {}\n", bench.greeting()));
  const BenchReport report = bench.play([] { return interrupted == 0; });
  if (!a.out.empty()) write_file(a.out, report_json(report));
  fmt::print("{}", report_lines(report));
  return kExitOk;
}

int play_runs(std::span<const FaultRun> runs, const std::vector<std::string>& only,
              const std::function<RunVerdict(const FaultRun&)>& play_run) {
  for (const std::string& name : only) {
    if (std::ranges::find(runs, name, &FaultRun::name) == runs.end()) {
      throw InputError(fmt::format("--only: no run '{}'", name));
    }
  }
  become_real_time();
  bool all_well = true;
  for (const FaultRun& run : runs) {
    if (!only.empty() && std::ranges::find(only, run.name) == only.end()) continue;
    const RunVerdict verdict = play_run(run);
    fmt::print("{} {}{}\n", verdict.wrong.empty() ? "ok    " : "FAILED", run.name,
               *run.hardware != '\0' ? fmt::format(" ({})", run.hardware) : "");
    for (const std::string& line : verdict.wrong) fmt::print("  {}\n", line);
    fmt::print("{}", verdict.report);
    std::fflush(stdout);
    all_well = all_well && verdict.wrong.empty();
  }
  return all_well ? kExitOk : kExitFailed;
}

int play_can_runs(const Arguments& a) {
  // The controller takes it over: what its ordinary threads do (figures, records) leaves a single
  // processor to the kernel's worker that hands on the serial line's bytes.
  setpriority(PRIO_PROCESS, 0, 19);
  return play_runs(can_fault_runs(), a.only,
                   [&](const FaultRun& run) { return run_can_fault(run, a.can); });
}

// Another try of the same run has a domain of its own: the wire of the one before may still damp.
// So has another process: a second list of runs on this computer is another program in a domain.
constexpr int kFirstDomain = 100, kDomains = 130;
// A busy computer may hold up several tries in a row; ten are no chance.
constexpr int kTries = 10;

int play_unitree_runs(const Arguments& a) {
  RunPlace place = a.unitree;
  place.command = fmt::format("{},0,0", a.unitree_mps);
  int domains = getpid();
  return play_runs(unitree_fault_runs(), a.only, [&](const FaultRun& run) {
    RunVerdict verdict;
    for (int tries = 0; tries < kTries; ++tries) {
      verdict = run_unitree_fault(run, place, kFirstDomain + domains++ % kDomains);
      if (verdict.wrong.empty() || !verdict.held_up) break;
    }
    return verdict;
  });
}

/// The options that both lists have.
void add_run_options(CLI::App& runs, RunPlace& place, std::vector<std::string>& only) {
  runs.add_option("--controller", place.controller, "the program")->type_name("FILE");
  runs.add_option("--out", place.out_dir, "folder for a folder of each run")->required();
  runs.add_option("--terrain", place.terrain, "ground")->type_name("PRESET|FILE");
  runs.add_option("--walk", place.walk_s, "s of the walks")->type_name("S");
  runs.add_option("--set", place.assignments, "one setting, for both; may be repeated")
      ->allow_extra_args(false);
  runs.add_option("--only", only, "these runs only")->delimiter(',');
}

int run(int argc, char** argv) {
  Arguments a;
  a.unitree.hardware.clear();
  a.unitree.walk_s = 20.0;
  CLI::App app(
      "Emulates a robot for a controller that runs elsewhere, in real time: twelve CAN drives and "
      "a serial IMU, or a Unitree robot over DDS. Reads the controller's own files.",
      "sandrunner-hil");
  app.option_defaults()->always_capture_default();
  app.add_option("--hardware", a.hardware, "hardware file, the same as the controller's")
      ->type_name("FILE")
      ->always_capture_default(false);
  app.add_option("--terrain", a.terrain, "ground: a preset or a TOML file")
      ->type_name("PRESET|FILE");
  app.add_option("--config", a.config_files, "TOML file with settings; may be repeated")
      ->type_name("FILE")
      ->always_capture_default(false);
  app.add_option("--set", a.assignments, "one setting; may be repeated")
      ->type_name("PATH=VALUE")
      ->allow_extra_args(false)
      ->always_capture_default(false);
  app.add_option("--imu", a.imu,
                 "this end of the IMU's serial line; without, a pseudo-terminal is made and "
                 "hardware.imu.device becomes a link to its other end")
      ->type_name("DEVICE")
      ->always_capture_default(false);
  app.add_option("--fault", a.faults,
                 "\"T KIND ...\", T in s since the drives were enabled, or start, or start+S; may "
                 "be repeated")
      ->allow_extra_args(false)
      ->always_capture_default(false);
  app.add_flag("--faults", a.list_faults, "list the kinds of faults, and end");
  app.add_option("--walk", a.walk_s, "s of the walk whose speed is measured; 0: all")
      ->type_name("S");
  app.add_option("--out", a.out, "file for the report, JSON")->type_name("FILE");
  CLI::App* const runs =
      app.add_subcommand("runs", "the list of fault runs, each with its own controller");
  runs->add_option("--hardware-dir", a.can.hardware,
                   "folder with mit.toml, damiao.toml, moteus.toml");
  runs->add_option("--imu-link", a.can.imu_link, "hardware.imu.device of the runs");
  runs->add_option("--command", a.can.command, "velocity vx,vy,wz");
  runs->add_option("--speed", a.can.speed_mps, "m/s expected of the walks, to 5 %");
  add_run_options(*runs, a.can, a.only);
  CLI::App* const unitree_runs = app.add_subcommand(
      "unitree-runs", "the list of fault runs of a Unitree robot, each with its own controller");
  unitree_runs
      ->add_option("--hardware", a.unitree.hardware,
                   "hardware file; its interface is taken to be lo")
      ->required();
  unitree_runs->add_option("--speed", a.unitree_mps,
                           "m/s commanded to walk; kept to 5 % as in process");
  add_run_options(*unitree_runs, a.unitree, a.only);
  app.footer(
      "Example:\n  sandrunner-hil --hardware moteus.toml --set hardware.imu.device=/tmp/imu "
      "--fault \"8 silent LF_KFE\"");
  if (!parse_command_line(app, argc, argv)) return kExitOk;
  if (a.list_faults) {
    fmt::print("{}", fault_kinds_help());
    return kExitOk;
  }
  flush_denormals_to_zero();
  if (runs->parsed()) return play_can_runs(a);
  if (unitree_runs->parsed()) return play_unitree_runs(a);
  if (a.hardware.empty()) throw InputError("--hardware: found none, expected a TOML file");
  return play(a);
}

}  // namespace
}  // namespace sandrunner::hil

int main(int argc, char** argv) {
  return sandrunner::run_program("sandrunner-hil",
                                 [&] { return sandrunner::hil::run(argc, argv); });
}
