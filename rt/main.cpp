// SPDX-License-Identifier: BSD-3-Clause
// sandrunner: the control process. This file assembles a run and reports; its parts are in run/.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "rt/base/errors.h"
#include "rt/base/input_file.h"
#include "rt/base/output_files.h"
#include "rt/base/program.h"
#include "rt/base/standard_error.h"
#include "rt/core/processor.h"
#include "rt/realtime/rt_report.h"
#include "rt/report/summary.h"
#include "rt/run/assemble.h"
#include "rt/run/command_source.h"
#include "rt/run/dds_bridge.h"
#include "rt/run/live_view.h"
#include "rt/run/operators.h"
#include "rt/run/options.h"
#include "rt/run/progress_line.h"
#include "rt/run/recording.h"
#include "rt/run/run.h"
#include "rt/run/run_files.h"
#include "rt/run/run_robot.h"
#include "rt/run/scene.h"
#include "rt/run/settings_reference.h"
#include "rt/run/signals.h"
#include "sim/robot/describe.h"
#include "sim/robot/new_robot.h"
#include "sim/robot/robot_model.h"

namespace sandrunner {
namespace {

constexpr int kLastWords_ms = 2000;

int check(const Options& options) {
  std::signal(SIGINT, SIG_DFL);  // which a script's & has it ignore
  const ProcessConfig config = read_config(options, nullptr);
  CheckTask task{
      .path = options.hardware_path,
      .nominal_rad = config.robot.nominal_rad,
      .plan = options.check.plan,
      .move = options.check.move,
      .nudge = options.check.nudge,
      .zero_pose_rad = {},
      .read = [&](const std::string& text) { return read_config(options, nullptr, &text).driver; }};
  if (options.check.zero == "lying") task.zero_pose_rad = config.robot.lying_rad;
  if (options.check.zero == "nominal") task.zero_pose_rad = config.robot.nominal_rad;
  return config.driver->check(task);
}

// Writes the files of --out; returns the line that names them. Throws InputError.
std::string write_results(const RunResult& result, const RunInfo& info,
                          const std::string& effective, const std::string& folder) {
  const std::string dir = folder + "/";
  // If not all can be written, those there are of one run, and not of an earlier one too; nor are
  // the pictures that tools/pictures.py makes.
  for (const char* name :
       {"summary.json", "config.toml", "run.csv", "run.html", "run.png", "strip.png"}) {
    std::error_code none_there;
    std::filesystem::remove(dir + name, none_there);
  }
  write_file(dir + "summary.json", summary_json(result, info));
  write_file(dir + "config.toml", effective);
  return fmt::format("wrote {0}summary.json, {0}config.toml, {1}\n", dir,
                     write_run_files(result.record, folder));
}

// Writes and prints what became of the run. Files first: standard output may have no reader any
// more. But what became of the robot is printed whatever becomes of the files. Throws InputError.
void report(const RunResult& result, const RunInfo& info, const Options& options,
            const std::string& effective, const RunRecording& recording, const RunRobot& robot) {
  std::string written;
  std::exception_ptr not_written;
  try {
    if (!options.out_dir.empty()) {
      written = write_results(result, info, effective, options.out_dir);
    }
    recording.require_whole();
  } catch (const InputError&) {
    not_written = std::current_exception();
  }
  const std::uint64_t never_seen = result.realtime ? result.realtime->records_dropped : 0;
  written += recording.report(never_seen) + robot.report();
  // A terminal that was stopped must not keep the process, which holds the buses, from its end.
  if (isatty(STDOUT_FILENO) == 0 || takes_output(STDOUT_FILENO, kLastWords_ms)) {
    fmt::print("{}{}", summary_table(result, info), written);
  }
  if (not_written) std::rethrow_exception(not_written);
}

RunInfo info_of(const Options& options, const CommandSource& command, const std::string& policy) {
  return {options.live ? options.command : command.text(), policy,
          options.hardware_path.empty() ? options.terrain : "real", clock_name(options.clock),
          options.seed};
}

int run(const Options& options) {
  const CommandSource command(options.live ? "0,0,0" : options.command);
  RunPolicy policy = load_run_policy(options);
  const ProcessConfig config = read_config(options, policy.runner.spec());
  if (options.dry_run) {
    fmt::print("{}", config.driver->dry_run(config.controller.stand));
    return kExitOk;
  }
  warn_of(config, policy.runner);
  if (!options.out_dir.empty()) prepare_folder(options.out_dir, "--out");
  if (config.driver) config.driver->fork_processes();
  flush_denormals_to_zero();
  SignalWatch signals;
  Operators operators(options, config, command, !policy.runner.is_none());
  std::optional<DdsBridge> dds;
  if (config.dds.enabled) dds.emplace(config, operators.desk(), options.clock);
  RunRecording recording(options, config, policy.file, policy.runner);
  RunRobot robot(options, config);
  const CutInACrash cut_in_a_crash(robot.io());
  RunRows rows{.scene = scene_of(config, policy.runner.name())};
  std::optional<LiveView> view;
  if (options.view) {
    view.emplace(rows.scene, config, options.clock, signals.interrupts(), operators,
                 robot.simulator());
    rows.sinks.push_back(&view->feed());
  }
  ProgressLine progress;
  Rig rig{.robot = robot.io(),
          .controller = config.controller,
          .start = options.start_walking ? Mode::kWalk : Mode::kPassive,
          .policy = policy.runner,
          .op = operators.input(),
          .between = view && view->has_pace() ? &*view : nullptr,
          .interrupts = signals.interrupts()};
  if (isatty(STDERR_FILENO) != 0) rig.sinks.push_back(&progress);
  recording.add_to(rig.sinks);
  if (dds) rig.sinks.push_back(&*dds);
  if (view) rig.sinks.insert(rig.sinks.end(), {&view->feed(), &view->topics()});
  SystemClock clock;
  signals.run_begins();
  RunResult result = options.clock == RunClock::kRealtime
                         ? run_in_realtime(rig, rows, config.realtime, clock)
                         : run_in_lockstep(rig, rows);
  operators.report(result);
  report(result, info_of(options, command, policy.runner.name()), options, config.effective,
         recording, robot);
  if (view) {
    std::fflush(stdout);
    while (signals.interrupts() == 0) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return result.survived ? kExitOk : kExitFailed;
}

/// Writes a robot file, and lets the robot stand up and lie down.
int begin_robot(const Options& options) {
  const std::string &urdf = options.new_robot_urdf, &file = options.robot_path;
  std::error_code none;
  if (std::filesystem::exists(file, none)) {
    throw InputError(fmt::format("new-robot: '{}' exists, expected a new file", file));
  }
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();
  const std::string path =
      std::filesystem::proximate(urdf, folder.empty() ? "." : folder, none).generic_string();
  const std::string text = read_input_file(urdf, "a URDF");
  const sim::NewRobot robot = sim::new_robot(text, urdf, path);
  sim::parse_robot(robot.file, file, text, urdf);
  write_file(file, robot.file);
  fmt::print("wrote {}\nguesses, for a person to check (sim/robot/README.md):\n", file);
  for (const std::string& guess : robot.guesses) fmt::print("  {}\n", guess);
  fmt::print("next: sandrunner --robot {} --describe\n\n", file);
  std::fflush(stdout);
  return run(options);
}

int run(int argc, char** argv) {
  const std::optional<Options> options = parse_options(argc, argv);
  if (!options) return kExitOk;
  if (options->settings) {
    fmt::print("{}", settings_reference());
    return kExitOk;
  }
  if (options->describe) {
    fmt::print("{}", sim::describe(read_config(*options, nullptr).robot));
    return kExitOk;
  }
  if (options->rt_report) {
    print_rt_report();
    return kExitOk;
  }
  if (!options->new_robot_urdf.empty()) return begin_robot(*options);
  return options->check.asked ? check(*options) : run(*options);
}

}  // namespace
}  // namespace sandrunner

int main(int argc, char** argv) {
  return sandrunner::run_program("sandrunner", [&] { return sandrunner::run(argc, argv); });
}
