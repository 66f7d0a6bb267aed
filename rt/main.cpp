// SPDX-License-Identifier: BSD-3-Clause
// sandrunner: the control process. This file parses, wires and reports; what happens in between is
// in run/.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "drivers/check/check.h"
#include "drivers/robot/bus_plan.h"
#include "drivers/robot/can_robot.h"
#include "drivers/robot/dry_run.h"
#include "policy/policy_file.h"
#include "rt/base/errors.h"
#include "rt/base/input_file.h"
#include "rt/base/output_files.h"
#include "rt/base/program.h"
#include "rt/base/standard_error.h"
#include "rt/core/floating_point.h"
#include "rt/core/mode_machine.h"
#include "rt/core/slower_rate.h"
#include "rt/operator/operator_desk.h"
#include "rt/operator/stand_again.h"
#include "rt/realtime/rt_report.h"
#include "rt/report/body_motion.h"
#include "rt/report/summary.h"
#include "rt/run/command_source.h"
#include "rt/run/dds_bridge.h"
#include "rt/run/options.h"
#include "rt/run/process_config.h"
#include "rt/run/recording.h"
#include "rt/run/run.h"
#include "rt/run/run_files.h"
#include "rt/run/run_script.h"
#include "rt/run/scene.h"
#include "rt/run/settings_reference.h"
#include "rt/run/signals.h"
#include "rt/run/simulator_hand.h"
#include "rt/telemetry/view/view_feed.h"
#include "rt/telemetry/view/view_pace.h"
#include "rt/telemetry/view/view_server.h"
#include "sim/ground/terrain_description.h"
#include "sim/simulator.h"

namespace sandrunner {
namespace {

constexpr int kLastWords_ms = 2000;

/// A line on a terminal, twice a second, that is gone at the end.
class ProgressLine final : public TickSink {
 public:
  void add(const TickRecord& tick) override {
    if (!rate_.due(tick.input.sensors.tick)) return;
    const RobotTruth& truth = tick.truth;
    const std::string where =
        tick.has_truth != 0 ? fmt::format("{:6.2f} m/s  x {:7.2f} m ",
                                          body_motion(truth.orientation_wxyz, truth.velocity_mps,
                                                      truth.angular_velocity_radps)
                                              .vx_mps,
                                          truth.position_m[0])
                            : "";
    to_standard_error(fmt::format("\r{:8.1f} s  {:<9} {}",
                                  static_cast<double>(tick.input.sensors.tick) * kControlPeriod_s,
                                  mode_name(tick.output.mode), where),
                      0);
  }
  void end() override { to_standard_error(fmt::format("\r{:60}\r", "")); }

 private:
  SlowerRate rate_{2};
};

// Writes the files of --out; returns the line that names them. Throws InputError.
std::string write_results(const RunResult& result, const RunInfo& info,
                          const std::string& effective, const std::string& folder) {
  const std::string dir = folder + "/";
  // If not all can be written, those there are of one run, and not of an earlier one too.
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

// `hardware`: text in place of the hardware file's own; null: that. `spec` may be null.
ProcessConfig read_config(const Options& options, const PolicySpec* spec,
                          const std::string* hardware = nullptr) {
  ConfigTree tree;
  sim::add_terrain_layer(tree, options.terrain);
  if (hardware) {
    tree.add_text(*hardware, options.hardware_path);
  } else if (!options.hardware_path.empty()) {
    tree.add_file(options.hardware_path);
  }
  for (const std::string& file : options.config_files) tree.add_file(file);
  for (const std::string& assignment : options.assignments) tree.set(assignment);
  if (options.live) tree.set(options.live_page ? "view.drive=true" : "dds.enabled=true");
  if (!options.dds_security_dir.empty()) {
    tree.set_text("dds.security_dir", options.dds_security_dir, "--dds-security");
  }
  if (!options.robot_path.empty()) tree.set_text("robot", options.robot_path, "--robot");
  ProcessConfig config = read_process_config(tree, spec);
  if (!options.hardware_path.empty() && !config.hardware) {
    throw InputError(fmt::format("{}: found no table [hardware]", options.hardware_path));
  }
  config.simulator.seed = options.seed;
  return config;
}

// The robot itself, or the simulator in its place.
struct TheRobot {
  std::unique_ptr<CanRobot> hardware;
  std::unique_ptr<sim::Simulator> simulator;

  RobotIo& io() { return hardware ? static_cast<RobotIo&>(*hardware) : *simulator; }
};

TheRobot make_robot(const Options& options, const ProcessConfig& config) {
  TheRobot robot;
  if (!options.hardware_path.empty()) {
    robot.hardware = std::make_unique<CanRobot>(*config.hardware, config.robot.description,
                                                config.controller.gate);
  } else {
    robot.simulator = std::make_unique<sim::Simulator>(config.robot, config.simulator);
    if (!options.start_walking) robot.simulator->reset_lying();
  }
  return robot;
}

// A run in a browser.
struct LiveView final : BetweenTicks {
  /// `simulator`: null unless in lockstep on simulated ground; so is `stand_again` without
  /// operators.
  LiveView(const RunScene& scene, const ProcessConfig& config, RunClock clock,
           const std::atomic<int>& interrupts, OperatorDesk* desk, sim::Simulator* simulator,
           StandAgain* stand_again)
      : feed(scene) {
    if (clock == RunClock::kLockstep) pace.emplace(interrupts);
    if (pace && simulator) {
      hand.emplace(*simulator, config.simulator.terrain, config.effective, stand_again);
    }
    server.emplace(config.view_port, ViewServer::Parts{.feed = feed,
                                                       .pace = pace ? &*pace : nullptr,
                                                       .desk = config.view_drive ? desk : nullptr,
                                                       .hand = hand ? &*hand : nullptr});
    to_standard_error(fmt::format("sandrunner: look at {}\n", server->url()));
  }

  RobotNow act(std::uint64_t next, TickSinks sinks) override {
    pace->wait();
    return hand ? hand->act(next, sinks) : RobotNow::kAsBefore;
  }

  ViewFeed feed;
  std::optional<ViewPace> pace;
  std::optional<SimulatorHand> hand;
  std::optional<ViewServer> server;
};

// What takes the ticks of a run.
struct Sinks {
  std::optional<ProgressLine> progress;
  std::optional<RunRecording> recording;
  std::optional<DdsBridge> dds;
  std::optional<LiveView> view;

  std::vector<TickSink*> all() {
    std::vector<TickSink*> sinks;
    if (progress) sinks.push_back(&*progress);
    if (recording) recording->add_to(sinks);
    if (dds) sinks.push_back(&*dds);
    if (view) sinks.push_back(&view->feed);
    return sinks;
  }
};

int check(const Options& options) {
  const ProcessConfig config = read_config(options, nullptr);
  if (options.check.plan) {
    const std::vector<PlannedBus> plan = plan_buses(*config.hardware);
    fmt::print("{}", plan_table(*config.hardware, plan));
    const bool fits = std::ranges::none_of(plan, &PlannedBus::overloaded);
    return fits ? kExitOk : kExitFailed;
  }
  CheckTask task{.path = options.hardware_path,
                 .config = *config.hardware,
                 .robot = config.robot.description,
                 .gate = config.controller.gate,
                 .nominal_rad = config.robot.nominal_rad,
                 .move = options.check.move,
                 .nudge = options.check.nudge,
                 .zero_pose_rad = {},
                 .read = [&](const std::string& text) {
                   return *read_config(options, nullptr, &text).hardware;
                 }};
  if (options.check.zero == "lying") task.zero_pose_rad = config.robot.lying_rad;
  if (options.check.zero == "nominal") task.zero_pose_rad = config.robot.nominal_rad;
  return run_check(task);
}

// The frames that a standing robot would be sent.
std::string dry_run(const ProcessConfig& config) {
  const auto& stand = config.controller.stand;
  JointArray<JointSetPoint> points;
  for (int j = 0; j < kNumJoints; ++j) {
    points[j] = {.position_rad = stand.nominal_rad[j],
                 .kp_nmprad = stand.kp_nmprad,
                 .kd_nmsprad = stand.kd_nmsprad};
  }
  return dry_run(*config.hardware, config.robot.description, points);
}

int run(int argc, char** argv) {
  const std::optional<Options> options = parse_options(argc, argv);
  if (!options) return kExitOk;
  if (options->settings) {
    fmt::print("{}", settings_reference());
    return kExitOk;
  }
  if (options->rt_report) {
    print_rt_report();
    return kExitOk;
  }
  if (options->check.asked) return check(*options);
  const CommandSource command(options->live ? "0,0,0" : options->command);
  std::string policy_text;
  PolicyRunner policy;
  if (options->policy_path.empty()) {
    policy_text = shipped_policy_text();
    policy = PolicyRunner(load_policy_text(policy_text, "raibo.safetensors (built in)"));
  } else if (options->policy_path != kNoPolicy) {
    policy_text = read_input_file(options->policy_path, "a policy file");
    policy = PolicyRunner(load_policy_text(policy_text, options->policy_path));
  }
  const ProcessConfig config = read_config(*options, policy.spec());
  if (options->dry_run) {
    fmt::print("{}", dry_run(config));
    return kExitOk;
  }
  if (policy.spec() && !policy.spec()->has_envelope) {
    to_standard_error(
        fmt::format("sandrunner: policy '{}' does not say which commands it can follow: they are "
                    "held to a narrow envelope (sandrunner-policy envelope)\n",
                    policy.name()));
  }
  if (config.controller.gate.hanging) {
    to_standard_error(
        "sandrunner: hardware.hanging: tilt and free fall are not judged, nor would a fall on the "
        "ground be; the robot does not walk\n");
  }
  const bool out = !options->out_dir.empty();
  if (out) prepare_folder(options->out_dir, "--out");

  flush_denormals_to_zero();
  SignalWatch signals;
  std::optional<RemoteOperator> remote;
  std::optional<OperatorDesk> desk;
  const char* const no_walk = config.controller.gate.hanging
                                  ? "the robot hangs (hardware.hanging), it may not walk"
                              : policy.is_none() ? "no policy to walk with"
                                                 : nullptr;
  if (options->live) {
    remote.emplace(config.dds.stale_ticks());
    desk.emplace(*remote, config.dds.stale_s, no_walk);
  }
  OperatorDesk* const open_desk = desk ? &*desk : nullptr;
  std::optional<StandAgain> stand_again;
  if (remote && options->view && options->clock == RunClock::kLockstep)
    stand_again.emplace(*remote);
  Sinks sinks;
  if (config.dds.enabled) sinks.dds.emplace(config, open_desk, options->clock);
  sinks.recording.emplace(*options, config, policy_text, policy);
  TheRobot robot = make_robot(*options, config);
  const CutInACrash cut_in_a_crash(robot.io());
  if (robot.hardware) {
    for (const std::string& line : unguarded(*config.hardware)) {
      to_standard_error(fmt::format("sandrunner: {}\n", line));
    }
  }

  const RunScene scene = scene_of(config, policy.name());
  if (options->view) {
    sinks.view.emplace(scene, config, options->clock, signals.interrupts(), open_desk,
                       robot.simulator.get(), stand_again ? &*stand_again : nullptr);
  }

  if (isatty(STDERR_FILENO) != 0) sinks.progress.emplace();
  RunScript script(command,
                   {.walk_s = options->duration_s, .start_walking = options->start_walking},
                   no_walk == nullptr);
  const Rig rig{.robot = robot.io(),
                .controller = config.controller,
                .start = options->start_walking ? Mode::kWalk : Mode::kPassive,
                .policy = policy,
                .op = stand_again ? static_cast<OperatorInput&>(*stand_again)
                      : remote    ? static_cast<OperatorInput&>(*remote)
                                  : script,
                .sinks = sinks.all(),
                .between = sinks.view && sinks.view->pace ? &*sinks.view : nullptr,
                .interrupts = signals.interrupts()};
  RunRows rows{.scene = scene};
  if (sinks.view) rows.sinks.push_back(&sinks.view->feed);
  SystemClock clock;
  RunResult result = options->clock == RunClock::kRealtime
                         ? run_in_realtime(rig, rows, config.realtime, clock)
                         : run_in_lockstep(rig, rows);
  if (!remote) script.report(result);

  // Files first: nobody may be listening on standard output any more. But what became of the robot
  // is told whatever becomes of them.
  const RunInfo info{options->live ? options->command : command.text(), policy.name(),
                     robot.hardware ? "real" : options->terrain, clock_name(options->clock),
                     options->seed};
  std::string written;
  std::exception_ptr not_written;
  try {
    if (out) written = write_results(result, info, config.effective, options->out_dir);
    sinks.recording->require_whole();
  } catch (const InputError&) {
    not_written = std::current_exception();
  }
  written += sinks.recording->report();
  if (robot.hardware) {
    written += hardware_report(*robot.hardware, *config.hardware, config.robot.description);
  }
  // A terminal that was stopped must not keep the process, which holds the buses, from its end.
  if (isatty(STDOUT_FILENO) == 0 || takes_output(STDOUT_FILENO, kLastWords_ms)) {
    fmt::print("{}{}", summary_table(result, info), written);
  }
  if (not_written) std::rethrow_exception(not_written);
  if (sinks.view) {
    std::fflush(stdout);
    while (signals.interrupts() == 0) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return result.survived ? kExitOk : kExitFailed;
}

}  // namespace
}  // namespace sandrunner

int main(int argc, char** argv) {
  return sandrunner::run_program("sandrunner", [&] { return sandrunner::run(argc, argv); });
}
