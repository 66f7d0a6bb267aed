// SPDX-License-Identifier: BSD-3-Clause
// sandrunner-hil: the simulated robot at the other end of the controller's CAN buses and serial
// line.
#include <fmt/format.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "rt/base/command_line.h"
#include "rt/base/errors.h"
#include "rt/base/output_files.h"
#include "rt/base/program.h"
#include "rt/base/standard_error.h"
#include "rt/core/floating_point.h"
#include "tools/hil/bench.h"
#include "tools/hil/bench_config.h"
#include "tools/hil/run_controller.h"
#include "tools/hil/unitree_bench.h"
#include "tools/hil/unitree_runs.h"

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
  RunPlace place;
  UnitreePlace unitree;
};

int play_unitree(const Arguments& a, const ProcessConfig& config) {
  std::vector<TimedUnitreeFault> faults;
  for (const std::string& text : a.faults) {
    faults.push_back(read_unitree_fault(text, config.robot.description));
  }
  // First: the threads of DDS take the priority over, or a busy computer loses commands.
  become_real_time();
  UnitreeBench bench(config, std::move(faults), a.walk_s);
  to_standard_error(
      fmt::format("sandrunner-hil: the robot is there, in domain {} on {}; Ctrl-C "
                  "ends it\n",
                  config.unitree->domain, config.unitree->interface));
  const UnitreeReport report = bench.play([] { return interrupted == 0; });
  if (!a.out.empty()) write_file(a.out, unitree_report_json(report));
  fmt::print("{}", unitree_report_lines(report));
  return kExitOk;
}

int play(const Arguments& a) {
  const ProcessConfig config =
      read_bench_config(a.hardware, a.terrain, a.config_files, a.assignments);
  std::signal(SIGINT, [](int) { interrupted = 1; });
  std::signal(SIGTERM, [](int) { interrupted = 1; });
  if (config.unitree) return play_unitree(a, config);
  std::vector<TimedFault> faults;
  for (const std::string& text : a.faults) {
    faults.push_back(read_fault(text, *config.hardware, config.robot.description));
  }
  Bench bench(config, a.imu, std::move(faults), a.walk_s);
  become_real_time();
  to_standard_error("sandrunner-hil: twelve drives and the IMU are there; Ctrl-C ends them\n");
  const BenchReport report = bench.play([] { return interrupted == 0; });
  if (!a.out.empty()) write_file(a.out, report_json(report, config.robot.description));
  fmt::print("{}", report_lines(report, config.robot.description));
  return kExitOk;
}

int play_runs(const Arguments& a) {
  // The controller takes it over: what its ordinary threads do (figures, records) leaves a single
  // processor to the kernel's worker that hands on the serial line's bytes.
  setpriority(PRIO_PROCESS, 0, 19);
  become_real_time();
  bool all_well = true;
  for (const FaultRun& run : fault_runs()) {
    if (!a.only.empty() && std::find(a.only.begin(), a.only.end(), run.name) == a.only.end()) {
      continue;
    }
    const RunVerdict verdict = run_controller(run, a.place);
    fmt::print("{} {} ({})\n", verdict.wrong.empty() ? "ok    " : "FAILED", run.name, run.hardware);
    for (const std::string& line : verdict.wrong) fmt::print("  {}\n", line);
    fmt::print("{}", verdict.report);
    std::fflush(stdout);
    all_well = all_well && verdict.wrong.empty();
  }
  return all_well ? kExitOk : kExitFailed;
}

// Another try of the same run has a domain of its own: the wire of the one before may still damp.
constexpr int kFirstDomain = 100, kDomains = 130, kTries = 4;

int play_unitree_runs(const Arguments& a) {
  become_real_time();
  bool all_well = true;
  int domains = 0;
  for (const UnitreeRun& run : unitree_runs()) {
    if (!a.only.empty() && std::find(a.only.begin(), a.only.end(), run.name) == a.only.end()) {
      continue;
    }
    UnitreeVerdict verdict;
    for (int tries = 0; tries < kTries; ++tries) {
      verdict = run_unitree(run, a.unitree, kFirstDomain + domains++ % kDomains);
      if (verdict.wrong.empty() || !verdict.held_up) break;
    }
    fmt::print("{} {}\n", verdict.wrong.empty() ? "ok    " : "FAILED", run.name);
    for (const std::string& line : verdict.wrong) fmt::print("  {}\n", line);
    fmt::print("{}", verdict.report);
    std::fflush(stdout);
    all_well = all_well && verdict.wrong.empty();
  }
  return all_well ? kExitOk : kExitFailed;
}

template <typename Runs>
void require_known(const std::vector<std::string>& only, const Runs& runs) {
  for (const std::string& name : only) {
    if (std::ranges::none_of(runs, [&](const auto& run) { return name == run.name; })) {
      throw InputError(fmt::format("--only: no run '{}'", name));
    }
  }
}

int run(int argc, char** argv) {
  Arguments a;
  CLI::App app(
      "Emulates a robot for a controller that runs elsewhere, in real time: twelve CAN drives and "
      "a "
      "serial IMU, or a Unitree robot over DDS. Reads the controller's own files.",
      "sandrunner-hil");
  app.option_defaults()->always_capture_default();
  app.add_option("--hardware", a.hardware, "hardware file, the same as the controller's")
      ->type_name("FILE")
      ->always_capture_default(false);
  app.add_option("--terrain", a.terrain, "ground: a preset or a TOML file");
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
  app.add_option("--walk", a.walk_s, "s of the walk whose speed is measured; 0: all")
      ->type_name("S");
  app.add_option("--out", a.out, "file for the report, JSON")->type_name("FILE");
  CLI::App* const runs =
      app.add_subcommand("runs", "the list of fault runs, each with its own controller");
  RunPlace& p = a.place;
  runs->add_option("--controller", p.controller, "the program")->type_name("FILE");
  runs->add_option("--hardware-dir", p.hardware_dir,
                   "folder with mit.toml, damiao.toml, moteus.toml");
  runs->add_option("--imu-link", p.imu_link, "hardware.imu.device of the runs");
  runs->add_option("--out", p.out_dir, "folder for a folder of each run")->required();
  runs->add_option("--terrain", p.terrain, "ground");
  runs->add_option("--command", p.command, "velocity vx,vy,wz");
  runs->add_option("--walk", p.walk_s, "s of the walks");
  runs->add_option("--speed", p.speed_mps, "m/s expected of the walks, to 5 %");
  runs->add_option("--set", p.assignments, "one setting, for both; may be repeated")
      ->allow_extra_args(false);
  runs->add_option("--only", a.only, "these runs only")->delimiter(',');
  CLI::App* const unitree_runs_command = app.add_subcommand(
      "unitree-runs", "the list of fault runs of a Unitree robot, each with its own controller");
  UnitreePlace& u = a.unitree;
  unitree_runs_command->add_option("--controller", u.controller, "the program")->type_name("FILE");
  unitree_runs_command
      ->add_option("--hardware", u.hardware, "hardware file; its interface is taken to be lo")
      ->required();
  unitree_runs_command->add_option("--out", u.out_dir, "folder for a folder of each run")
      ->required();
  unitree_runs_command->add_option("--terrain", u.terrain, "ground");
  unitree_runs_command->add_option("--speed", u.speed_mps,
                                   "m/s commanded to walk; kept to 5 % as in process");
  unitree_runs_command->add_option("--walk", u.walk_s, "s of the walk");
  unitree_runs_command->add_option("--set", u.assignments, "one setting, for both; may be repeated")
      ->allow_extra_args(false);
  unitree_runs_command->add_option("--only", a.only, "these runs only")->delimiter(',');
  app.footer("Kinds of faults:\n" + fault_kinds_help() + "Of a Unitree robot, without +S:\n" +
             unitree_fault_kinds_help() +
             "Example:\n  sandrunner-hil --hardware moteus.toml --set hardware.imu.device=/tmp/imu "
             "--fault \"8 silent LF_KFE\"");
  if (!parse_command_line(app, argc, argv)) return kExitOk;
  flush_denormals_to_zero();
  if (runs->parsed()) {
    require_known(a.only, fault_runs());
    return play_runs(a);
  }
  if (unitree_runs_command->parsed()) {
    require_known(a.only, unitree_runs());
    return play_unitree_runs(a);
  }
  if (a.hardware.empty()) throw InputError("--hardware: found none, expected a TOML file");
  return play(a);
}

}  // namespace
}  // namespace sandrunner::hil

int main(int argc, char** argv) {
  return sandrunner::run_program("sandrunner-hil",
                                 [&] { return sandrunner::hil::run(argc, argv); });
}
