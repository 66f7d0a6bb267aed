// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/run_fault.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>

#include "drivers/unitree/unitree_driver.h"
#include "policy/policy_file.h"
#include "rt/base/errors.h"
#include "rt/base/output_files.h"
#include "rt/run/run.h"
#include "rt/run/run_script.h"
#include "rt/run/scene.h"
#include "tools/hil/bench.h"
#include "tools/hil/bench_config.h"
#include "tools/hil/controller_process.h"
#include "tools/hil/diagnosis.h"

namespace sandrunner::hil {
namespace {

constexpr double kSpeedTolerance = 0.05;
constexpr double kSilent_s = 0.3;  // without a command: time-outs and the wire's damping are over
constexpr double kMost_s = 120.0;
constexpr double kQuestion_s = 0.01;
constexpr double kHeldUp_s = 0.004;
constexpr double kOthersWalk_s = 1.0;

using Lines = std::vector<std::string>;

/// What differs between the lists.
struct Expectation {
  double walk_s, speed_mps;  ///< 0: the speed is not judged
  double late_s;             ///< what the bench may have been held up adds to a time
};

/// Speed of the same walk with the simulator in this process, m/s.
double speed_in_process(const ProcessConfig& config, const RunPlace& place) {
  const std::string& name = config.robot.description.name;
  PolicyRunner policy(shipped_policy_text(name).empty() ? load_shipped_policy()
                                                        : load_shipped_policy(name));
  sim::Simulator simulator(config.robot, config.simulator);
  simulator.reset_lying();
  const CommandSource command(place.command);
  RunScript script(command, {.walk_s = place.walk_s}, true);
  const RunResult result = run_in_lockstep(
      {.robot = simulator, .controller = config.controller, .policy = policy, .op = script},
      {.scene = scene_of(config, policy.name())});
  return result.figures.motion ? result.figures.motion->mean_velocity_mps[0] : 0.0;
}

std::string how_it_ended(const std::optional<int>& code) {
  if (!code) return "does not end";
  return *code == kKilled ? "was ended by a signal" : fmt::format("ended with exit code {}", *code);
}

/// `also`: what a second controller printed.
void judge_controller(const FaultRun& run, const std::optional<int>& ended,
                      const std::string& printed, const std::string& also,
                      const RobotDescription& robot, Lines& wrong) {
  if (run.exit_code != kNoMatter && ended != run.exit_code) {
    wrong.push_back(fmt::format(
        "the controller {}, expected {}; it printed last:\n{}", how_it_ended(ended),
        run.exit_code == kKilled ? "a signal" : fmt::format("exit code {}", run.exit_code),
        last_lines(printed)));
  }
  const Diagnosis found = diagnosis(printed);
  const std::set<std::string> joints = run.joints_of(robot);
  if (run.exit_code >= 0 && found.fault != run.bit) {
    wrong.push_back(fmt::format("fault '{}', expected '{}'", found.fault, run.bit));
  }
  if (*run.bit != '\0' && found.joints != joints) {
    wrong.push_back(fmt::format("joints '{}', expected '{}'", fmt::join(found.joints, " "),
                                fmt::join(joints, " ")));
  }
  if ((printed + also).find(run.says) == std::string::npos) {
    wrong.push_back(fmt::format("its output does not say '{}'", run.says));
  }
}

void judge_bench(const FaultRun& run, const Expectation& expected, const BenchReport& report,
                 bool all_faults_made, Lines& wrong) {
  const Score& score = report.score;
  const auto require = [&](const char* what, double bound_s, std::optional<double> found_s) {
    if (bound_s <= 0.0) return;
    const double most_s = bound_s + expected.late_s;
    if (found_s && *found_s <= most_s) return;
    const std::string found = found_s ? fmt::format("after {:.2f} ms", 1e3 * *found_s) : "never";
    wrong.push_back(fmt::format("{} {}, expected {:.2f} ms", what, found, 1e3 * most_s));
  };
  if (!report.link.wrong.empty()) wrong.push_back(report.link.wrong);
  if (!all_faults_made) {
    wrong.emplace_back("the fault was never made");
  } else if (!score.faults.empty()) {
    require("damped", run.damped_within_s, score.faults.back().damped_after_s);
    require("all passive", run.passive_within_s, score.faults.back().passive_after_s);
  }
  if (run.exit_code == 2 && score.enabled_at_s) wrong.emplace_back("the drives were enabled");
  if (run.exit_code != 0) return;
  if (!score.enabled_at_s) wrong.emplace_back("the drives were never all enabled");
  if (!score.off_at_end) wrong.emplace_back("not all drives are off at the end");
  if (score.base_touched) wrong.emplace_back("the robot fell");
  if (expected.speed_mps <= 0.0) return;
  const double speed_mps = score.mean_speed_mps.value_or(score.distance_m / expected.walk_s);
  if (std::fabs(speed_mps - expected.speed_mps) > kSpeedTolerance * expected.speed_mps) {
    wrong.push_back(fmt::format(
        "walked at {:.3f} m/s{}, expected {:.3f} to 5 %", speed_mps,
        score.mean_speed_mps ? ""
                             : fmt::format(" of distance over time, as {}", score.why_no_speed()),
        expected.speed_mps));
  }
}

/// What a controller prints that was itself held up.
bool was_held_up(const FaultRun& run, const std::string& printed) {
  for (const std::string fault : {"loop_stalled", "policy_stale", "drives_cut", "joints_stale"}) {
    if (fault != run.bit && printed.find("FAILED: " + fault) != std::string::npos) return true;
  }
  return false;
}

/// Runs the controller of `place`, whose hardware and assignments are those of this run. `shared`:
/// in real time on a computer that other programs may hold up.
RunVerdict run_fault(const FaultRun& run, const RunPlace& place, const ProcessConfig& config,
                     double speed_mps, bool shared) {
  const std::string dir = place.out_dir + "/" + run.name;
  prepare_folder(dir, "--out");
  const RobotDescription& robot = config.robot.description;
  Bench bench(config, "", read_faults(config, run.faults_of(robot)), place.walk_s);
  Lines command = {
      place.controller, "--hardware",  place.hardware, "--arm",
      "--command",      place.command, "--duration",   fmt::format("{}", place.walk_s)};
  for (const std::string& assignment : place.assignments) {
    command.insert(command.end(), {"--set", assignment});
  }
  if (*run.setting != '\0') command.insert(command.end(), {"--set", run.setting});
  ControllerProcess controller(command, dir);
  std::optional<ControllerProcess> second;
  const auto start_second = [&] {
    Lines words = command;
    words.insert(words.end(), {"--set", "hardware.imu.device=/dev/null"});
    prepare_folder(dir + "/second", "--out");
    second.emplace(words, dir + "/second");
  };
  double time_s = 0.0;
  const BenchReport report = bench.play(
      [&] {
        time_s += kQuestion_s;
        const bool over = controller.ended() || (run.exit_code < 0 && bench.all_faults_made());
        return !(over && bench.silent_s() >= kSilent_s) && time_s < kMost_s;
      },
      controller.pid(), start_second);
  write_file(dir + "/bench.json", report_json(report));

  RunVerdict verdict;
  verdict.report = report_lines(report);
  const std::string printed = text_of(dir + "/log.txt");
  verdict.held_up = shared && (report.late_longest_s > kHeldUp_s || was_held_up(run, printed));
  judge_controller(run, controller.ended(), printed, second ? text_of(dir + "/second/log.txt") : "",
                   robot, verdict.wrong);
  if (second && second->ended() != kExitBadInput) {
    verdict.wrong.emplace_back("the second one was not refused");
  }
  const Expectation expected{.walk_s = place.walk_s,
                             .speed_mps = speed_mps,
                             .late_s = shared ? report.late_longest_s : 0.0};
  judge_bench(run, expected, report, bench.all_faults_made(), verdict.wrong);
  return verdict;
}

}  // namespace

RunVerdict run_can_fault(const FaultRun& run, const RunPlace& place) {
  RunPlace own = place;
  own.hardware = std::filesystem::absolute(place.hardware + "/" + run.hardware + ".toml");
  own.assignments.push_back("hardware.imu.device=" + place.imu_link);
  own.assignments.emplace_back(
      "hardware.timeout_unverified=true");  // the bench's drives have theirs
  const ProcessConfig config = read_bench_config(own.hardware, own.terrain, {}, own.assignments);
  return run_fault(run, own, config, place.speed_mps, false);
}

RunVerdict run_unitree_fault(const FaultRun& run, const RunPlace& place, int domain) {
  RunPlace own = place;
  own.hardware = std::filesystem::absolute(place.hardware);
  own.assignments.emplace_back("hardware.unitree.interface=lo");
  own.assignments.push_back(fmt::format("hardware.unitree.domain={}", domain));
  if (!run.nothing_goes_wrong()) own.walk_s = kOthersWalk_s;
  const ProcessConfig config = read_bench_config(own.hardware, own.terrain, {}, own.assignments);
  if (!dynamic_cast<const UnitreeDriver*>(config.driver.get())) {
    throw InputError(
        fmt::format("{}: found another kind of hardware, expected unitree", own.hardware));
  }
  const double speed_mps = run.nothing_goes_wrong() ? speed_in_process(config, own) : 0.0;
  return run_fault(run, own, config, speed_mps, true);
}

}  // namespace sandrunner::hil
