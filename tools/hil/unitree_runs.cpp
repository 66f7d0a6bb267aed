// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/unitree_runs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>

#include "policy/policy_file.h"
#include "rt/base/errors.h"
#include "rt/base/output_files.h"
#include "rt/run/run.h"
#include "rt/run/run_script.h"
#include "rt/run/scene.h"
#include "tools/hil/bench_config.h"
#include "tools/hil/controller_process.h"
#include "tools/hil/diagnosis.h"
#include "tools/hil/unitree_bench.h"

namespace sandrunner::hil {
namespace {

constexpr const char* kDamping = "damping, then off";
constexpr const char* kLiesDown = "stops, stands, lies down, then off";
constexpr const char* kWalksOn = "walks on; counted";
constexpr const char* kWire = "the wire damps, then off";
constexpr const char* kGuard = "the wire's guard damps, then off";
constexpr const char* kNotStarted = "nothing is commanded";
constexpr const char* kStale = "joints_stale";
constexpr const char* kForeign = "ANOTHER PROGRAM COMMANDS THE ROBOT";
constexpr auto kNone = NamedJoints::kNone, kOne = NamedJoints::kOne, kAll = NamedJoints::kAll;

// Joint values are a fault when they are 10 ms old; the state before was up to 2 ms old when the
// fault began, and a command takes up to 2 ms to the wire and 2 ms to the robot's next look.
constexpr double kStale_s = 0.016, kAtOnce_s = 0.008, kWire_s = 0.052;
// The guard joins the domain first.
constexpr double kGuard_s = 0.1;

constexpr auto kRuns = std::to_array<UnitreeRun>({
    {"gap-4", "states are missing for 4 ms", "1 gap 4", "", kNone, "", kWalksOn, 0, 0.0},
    {"gap-6", "states are missing for 6 ms", "1 gap 6", "", kNone, "", kWalksOn, 0, 0.0},
    {"gap-12", "states are missing for 12 ms", "1 gap 12", kStale, kAll, "", kDamping, 1, kStale_s},
    {"gap-20", "states are missing for 20 ms", "1 gap 20", kStale, kAll, "", kDamping, 1, kStale_s},
    {"gap-50", "states are missing for 50 ms", "1 gap 50", kStale, kAll, "", kDamping, 1, kStale_s},
    {"gap-100", "states are missing for 100 ms", "1 gap 100", kStale, kAll, "", kDamping, 1,
     kStale_s},
    {"silent", "states are missing from now on", "1 silent", kStale, kAll, "", kDamping, 1,
     kStale_s},
    {"burst-6", "states are held up for 6 ms, then come at once", "1 burst 6", "", kNone, "",
     kWalksOn, 0, 0.0},
    {"burst-100", "states are held up for 100 ms, then come at once", "1 burst 100", kStale, kAll,
     "", kDamping, 1, kStale_s},
    {"late", "states are late by 20 ms from now on", "1 late 20", kStale, kAll, "", kDamping, 1,
     kStale_s},
    {"jitter", "states are late by up to 3 ms, by chance", "1 jitter 3", "", kNone, "", kWalksOn, 0,
     0.0},
    {"loses", "every tenth state is lost", "1 loses 10", "", kNone, "", kWalksOn, 0, 0.0},
    {"bad-crc", "states have a wrong CRC", "1 bad-crc", kStale, kAll, "with a WRONG CRC", kDamping,
     1, kStale_s},
    {"no-crc", "states have no CRC", "1 no-crc", "", kNone, "without a CRC", kWalksOn, 0, 0.0},
    {"nan", "a joint's position is not a number", "1 nan {}", kStale, kAll, "NOT FINITE", kDamping,
     1, kStale_s},
    {"stuck", "the clock in the states stands still", "1 stuck", kStale, kAll, "REPEATED", kDamping,
     1, kStale_s},
    {"backwards", "the clock in the states goes back by 1 s", "1 backwards", kStale, kAll,
     "WENT BACK", kDamping, 1, kStale_s},
    {"lost", "the robot's own bus hears no more of a motor", "1 lost {}", kStale, kOne,
     "lost by the robot's own bus", kDamping, 1, kStale_s},
    {"warm", "a motor is at 85 degrees C, in Walk", "6 hot {} 85", "drive_warning", kNone,
     "too hot", kLiesDown, 1, 0.0},
    {"hot", "a motor is at 95 degrees C", "1 hot {} 95", "drive_fault", kOne, "too hot", kDamping,
     1, kAtOnce_s},
    {"mode", "a motor is off by itself", "1 mode {} 0", "drive_fault", kOne,
     "another mode than commanded", kDamping, 1, kAtOnce_s},
    {"battery-low", "the battery has 8 %, in Walk", "6 battery 8", "drive_warning", kNone,
     "battery low", kLiesDown, 1, 0.0},
    {"battery", "the battery has 4 %", "1 battery 4", "drive_fault", kAll, "battery low", kDamping,
     1, kAtOnce_s},
    {"foreign", "another program sends one command", "1 foreign 1", "foreign_traffic", kAll,
     kForeign, "damping for 10 ms, then silence", 1, kAtOnce_s},
    {"sport", "sport mode is on again, and commands the robot", "1 sport", "foreign_traffic", kAll,
     kForeign, "damping for 10 ms, then silence", 1, kAtOnce_s},
    {"remote-stop", "L2 and B of the remote are pressed", "1 remote-stop", "emergency_stop", kNone,
     "", kDamping, 1, kAtOnce_s},
    {"remote-lost", "the remote is switched off", "1 remote-lost", "emergency_stop", kNone, "",
     kDamping, 1, 0.21},
    {"wrong-type", "states are of another type", "start wrong-type", "", kNone,
     "found another type than unitree_go::msg::dds_::LowState_", kNotStarted, 2, 0.0},
    {"wrong-interface", "the network interface is another one", "", "", kNone, "nosuch0",
     kNotStarted, 2, 0.0, "", "hardware.unitree.interface=nosuch0"},
    {"sport-start", "sport mode commands the robot after its release", "start sport", "", kNone,
     "commands of another program", kNotStarted, 2, 0.0},
    {"no-remote", "the remote is off at the start", "start remote-lost", "", kNone,
     "remote control: found none", kNotStarted, 2, 0.0},
    {"kill", "SIGKILL to the controller, in Walk; the firmware holds commands", "6 kill", "", kNone,
     "", kWire, -1, kWire_s},
    {"kill-damps", "the same; the firmware damps after 100 ms", "6 kill", "", kNone, "", kWire, -1,
     kWire_s, "start firmware-damps"},
    {"crash", "SIGSEGV to the controller; the firmware holds commands", "1 crash", "", kNone, "",
     kWire, -1, kWire_s},
    {"crash-damps", "the same; the firmware damps after 100 ms", "1 crash", "", kNone, "", kWire,
     -1, kWire_s, "start firmware-damps"},
    {"stop", "SIGSTOP to the controller; the firmware holds commands", "1 stop", "", kNone, "",
     kWire, -1, kWire_s},
    {"stop-damps", "the same; the firmware damps after 100 ms", "1 stop", "", kNone, "", kWire, -1,
     kWire_s, "start firmware-damps"},
    {"hang", "the control thread hangs; the firmware holds commands", "1 hang", "", kNone,
     "the control thread hangs", kWire, 1, kWire_s},
    {"hang-damps", "the same; the firmware damps after 100 ms", "1 hang", "", kNone,
     "the control thread hangs", kWire, 1, kWire_s, "start firmware-damps"},
    {"wire-kill", "SIGKILL to the wire; the firmware holds commands", "1 wire-kill", kStale, kAll,
     "", kGuard, 1, kGuard_s},
    {"wire-kill-damps", "the same; the firmware damps after 100 ms", "1 wire-kill", kStale, kAll,
     "", kGuard, 1, kGuard_s, "start firmware-damps"},
    {"walks", "nothing", "", "", kNone, "", "walks", 0, 0.0},
});

constexpr int kFaultyJoint = 2;
constexpr double kOthersWalk_s = 1.0;
constexpr double kSpeedTolerance = 0.05;
constexpr double kSilent_s = 0.3;  // without a command: the wire's damping is over
constexpr double kMost_s = 90.0;
constexpr double kQuestion_s = 0.01;
constexpr double kHeldUp_s = 0.004;

bool nothing_goes_wrong(const UnitreeRun& run) {
  return *run.fault == '\0' && *run.first == '\0' && *run.setting == '\0';
}

std::string joints_text(NamedJoints joints) {
  return joints == kAll ? "all" : joints == kOne ? "that one" : "";
}

/// Of the same walk with the simulator in the controller's process, m/s.
double speed_in_process(const ProcessConfig& config, const UnitreePlace& place) {
  const std::string& name = config.robot.description.name;
  PolicyRunner policy(shipped_policy_text(name).empty() ? load_shipped_policy()
                                                        : load_shipped_policy(name));
  sim::Simulator simulator(config.robot, config.simulator);
  simulator.reset_lying();
  const CommandSource command(fmt::format("{},0,0", place.speed_mps));
  RunScript script(command, {.walk_s = place.walk_s}, true);
  const RunResult result = run_in_lockstep(
      {.robot = simulator, .controller = config.controller, .policy = policy, .op = script},
      {.scene = scene_of(config, policy.name())});
  return result.figures.motion ? result.figures.motion->mean_velocity_mps[0] : 0.0;
}

/// `expected_mps`: of the walk of a run in which nothing goes wrong.
void judge_bench(const UnitreeRun& run, double expected_mps, const UnitreeReport& report,
                 std::vector<std::string>& wrong) {
  if (report.refused > 0) {
    wrong.push_back(
        fmt::format("the robot refused {} commands: {}", report.refused, report.refusal));
  }
  if (run.damped_within_s > 0.0) {
    const FaultFigures* const last = report.faults.empty() ? nullptr : &report.faults.back();
    // What held up the bench itself counts for nothing.
    const double bound_s = run.damped_within_s + report.late_longest_s;
    if (last == nullptr) {
      wrong.emplace_back("the fault was never made");
    } else if (!last->damped_after_s || *last->damped_after_s > bound_s) {
      wrong.push_back(fmt::format(
          "damped after {} ms, expected {:.1f} ms",
          last->damped_after_s ? fmt::format("{:.1f}", 1e3 * *last->damped_after_s) : "no",
          1e3 * bound_s));
    }
  }
  if (run.exit_code == 2 && report.was_enabled) wrong.emplace_back("motors were commanded");
  if (run.exit_code != 0) return;
  if (!report.was_enabled) wrong.emplace_back("the motors were never commanded");
  if (!report.off_at_end) wrong.emplace_back("not all motors are off at the end");
  if (report.base_touched) wrong.emplace_back("the robot fell");
  if (!nothing_goes_wrong(run)) return;
  const double speed = report.mean_speed_mps.value_or(0.0);
  if (std::fabs(speed - expected_mps) > kSpeedTolerance * expected_mps) {
    wrong.push_back(fmt::format("walked at {:.3f} m/s, expected {:.3f} as in process to 5 %", speed,
                                expected_mps));
  }
}

void judge_controller(const UnitreeRun& run, const std::optional<int>& ended,
                      const std::string& printed, const RobotDescription& robot,
                      std::vector<std::string>& wrong) {
  if (run.exit_code >= 0 && ended != run.exit_code) {
    wrong.push_back(
        ended ? fmt::format("the controller ended with {}, expected {}", *ended, run.exit_code)
              : "the controller does not end");
  }
  const Diagnosis found = diagnosis(printed);
  if (found.fault != run.bit && run.exit_code >= 0) {
    wrong.push_back(fmt::format("fault '{}', expected '{}'", found.fault, run.bit));
  }
  std::set<std::string> joints;
  if (run.joints == kOne) joints.insert(robot.joint_names[kFaultyJoint]);
  if (run.joints == kAll) joints.insert(robot.joint_names.begin(), robot.joint_names.end());
  if (*run.bit != '\0' && found.joints != joints) {
    wrong.push_back(fmt::format("joints {}, expected {}", fmt::join(found.joints, " "),
                                fmt::join(joints, " ")));
  }
  if (printed.find(run.says) == std::string::npos) {
    wrong.push_back(fmt::format("its output does not say '{}'", run.says));
  }
}

/// What a controller says that was itself held up.
bool controller_held_up(const UnitreeRun& run, const std::string& printed) {
  for (const std::string fault : {"loop_stalled", "policy_stale", "drives_cut", "joints_stale"}) {
    if (fault != run.bit && printed.find("FAILED: " + fault) != std::string::npos) return true;
  }
  return false;
}

}  // namespace

std::span<const UnitreeRun> unitree_runs() { return kRuns; }

std::string unitree_run_markdown() {
  std::string table =
      "| what goes wrong | fault | joints named | then | damped within | exit code |\n"
      "|---|---|---|---|---|---|\n";
  for (const UnitreeRun& run : kRuns) {
    if (nothing_goes_wrong(run)) continue;
    table += fmt::format(
        "| {} | {} | {} | {} | {} | {} |\n", run.what,
        *run.bit != '\0'     ? fmt::format("`{}`", run.bit)
        : run.exit_code == 2 ? "refused at the start"
                             : "none",
        joints_text(run.joints), run.then,
        run.damped_within_s > 0.0 ? fmt::format("{:.0f} ms", 1e3 * run.damped_within_s) : "-",
        run.exit_code < 0 ? "-" : fmt::format("{}", run.exit_code));
  }
  return table;
}

UnitreeVerdict run_unitree(const UnitreeRun& run, const UnitreePlace& place, int domain) {
  const std::string dir = place.out_dir + "/" + run.name;
  prepare_folder(dir, "--out");
  const std::string hardware = std::filesystem::absolute(place.hardware);
  std::vector<std::string> assignments = place.assignments;
  assignments.emplace_back("hardware.unitree.interface=lo");
  assignments.push_back(fmt::format("hardware.unitree.domain={}", domain));
  const ProcessConfig config = read_bench_config(hardware, place.terrain, {}, assignments);
  if (!config.unitree) {
    throw InputError(fmt::format("{}: found another kind of hardware, expected unitree", hardware));
  }
  const RobotDescription& robot = config.robot.description;
  std::vector<TimedUnitreeFault> faults;
  for (const char* const script : {run.first, run.fault}) {
    if (*script == '\0') continue;
    faults.push_back(read_unitree_fault(
        fmt::format(fmt::runtime(script), robot.joint_names[kFaultyJoint]), robot));
  }
  const double walk_s = nothing_goes_wrong(run) ? place.walk_s : kOthersWalk_s;
  UnitreeBench bench(config, std::move(faults), walk_s);
  std::vector<std::string> command = {place.controller, "--hardware",
                                      hardware,         "--arm",
                                      "--command",      fmt::format("{},0,0", place.speed_mps),
                                      "--terrain",      place.terrain,
                                      "--duration",     fmt::format("{}", walk_s)};
  if (*run.setting != '\0') assignments.emplace_back(run.setting);
  for (const std::string& assignment : assignments) {
    command.insert(command.end(), {"--set", assignment});
  }
  ControllerProcess controller(command, dir);
  double time_s = 0.0;
  const UnitreeReport report = bench.play(
      [&] {
        time_s += kQuestion_s;
        const bool over = controller.ended() || (run.exit_code < 0 && bench.all_faults_made());
        return !(over && bench.silent_s() >= kSilent_s) && time_s < kMost_s;
      },
      controller.pid());
  write_file(dir + "/bench.json", unitree_report_json(report));

  UnitreeVerdict verdict;
  verdict.report = unitree_report_lines(report);
  const std::string printed = text_of(dir + "/log.txt");
  judge_bench(run, nothing_goes_wrong(run) ? speed_in_process(config, place) : 0.0, report,
              verdict.wrong);
  judge_controller(run, controller.ended(), printed, robot, verdict.wrong);
  verdict.held_up = report.late_longest_s > kHeldUp_s || controller_held_up(run, printed);
  return verdict;
}

}  // namespace sandrunner::hil
