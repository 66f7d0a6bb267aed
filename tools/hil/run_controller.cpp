// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/run_controller.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "rt/base/errors.h"
#include "rt/base/output_files.h"
#include "tools/hil/bench.h"
#include "tools/hil/bench_config.h"
#include "tools/hil/controller_process.h"
#include "tools/hil/diagnosis.h"

namespace sandrunner::hil {
namespace {

constexpr double kSpeedTolerance = 0.05;
constexpr std::uint64_t kQuestionsAfterwards = 20;  // 0.2 s: the drives' time-outs are over
constexpr std::uint64_t kMostQuestions = 12'000;    // 120 s

std::string ms(const std::optional<double>& time_s) {
  return time_s ? fmt::format("{:.2f} ms", 1e3 * *time_s) : "never";
}

void judge_bench(const FaultRun& run, const RunPlace& place, DriveMode mode,
                 const BenchReport& report, std::vector<std::string>& wrong) {
  const auto require = [&](const char* what, double bound_s, const std::optional<double>& found) {
    if (bound_s > 0.0 && (!found || *found > bound_s)) {
      wrong.push_back(fmt::format("{} after {}, expected {}", what, ms(found), ms(bound_s)));
    }
  };
  if (!report.faults.empty()) {
    require("damped", run.damped_within_s, report.faults[0].damped_after_s);
    require("all passive", run.passive_within_s, report.faults[0].passive_after_s);
  } else if (*run.fault != '\0') {
    wrong.emplace_back("the fault was never made");
  }
  if (run.exit_code == 2 && report.was_enabled) wrong.emplace_back("drives were enabled");
  if (run.exit_code != 0) return;
  if (!report.was_enabled) wrong.emplace_back("the drives were never all enabled");
  if (!report.all_off()) wrong.emplace_back("not all drives are off at the end");
  if (report.base_touched) wrong.emplace_back("the robot fell");
  if (place.speed_mps > 0.0) {
    // In torque mode drives are told no gains, and the bench cannot tell when the robot walks.
    const double speed = mode == DriveMode::kTorque ? report.distance_m / place.walk_s
                                                    : report.mean_speed_mps.value_or(0.0);
    if (std::fabs(speed - place.speed_mps) > kSpeedTolerance * place.speed_mps) {
      wrong.push_back(
          fmt::format("walked at {:.3f} m/s, expected {:.3f} to 5 %", speed, place.speed_mps));
    }
  }
}

}  // namespace

RunVerdict run_controller(const FaultRun& run, const RunPlace& place) {
  const std::string dir = place.out_dir + "/" + run.name;
  prepare_folder(dir, "--out");
  const std::string hardware =
      std::filesystem::absolute(fmt::format("{}/{}.toml", place.hardware_dir, run.hardware));
  std::vector<std::string> assignments = place.assignments;
  assignments.push_back("hardware.imu.device=" + place.imu_link);
  assignments.emplace_back("hardware.timeout_unverified=true");  // the bench's drives have theirs
  const ProcessConfig config = read_bench_config(hardware, place.terrain, {}, assignments);
  std::vector<TimedFault> faults;
  if (*run.fault != '\0') {
    faults.push_back(read_fault(run.fault, *config.hardware, config.robot.description));
  }
  Bench bench(config, "", std::move(faults), place.walk_s);

  std::vector<std::string> command = {
      place.controller, "--hardware", hardware,      "--arm",      "--command",
      place.command,    "--terrain",  place.terrain, "--duration", fmt::format("{}", place.walk_s)};
  for (const std::string& assignment : assignments) {
    command.insert(command.end(), {"--set", assignment});
  }
  ControllerProcess controller(command, dir);
  std::optional<ControllerProcess> second;
  const auto start_second = [&] {
    std::vector<std::string> words = command;
    words.insert(words.end(), {"--set", "hardware.imu.device=/dev/null"});
    prepare_folder(dir + "/second", "--out");
    second.emplace(words, dir + "/second");
  };
  std::uint64_t questions = 0, afterwards = 0;
  const BenchReport report = bench.play(
      [&] {
        if (controller.ended()) ++afterwards;
        return afterwards < kQuestionsAfterwards && ++questions < kMostQuestions;
      },
      controller.pid(), start_second);
  write_file(dir + "/bench.json", report_json(report, config.robot.description));

  RunVerdict verdict;
  verdict.report = report_lines(report, config.robot.description);
  judge_bench(run, place, config.hardware->mode, report, verdict.wrong);
  const std::optional<int> ended = controller.ended();
  if (ended != run.exit_code) {
    verdict.wrong.push_back(
        ended ? fmt::format("the controller ended with {}, expected {}", *ended, run.exit_code)
              : "the controller does not end");
  }
  std::string printed = text_of(dir + "/log.txt");
  const Diagnosis found = diagnosis(printed);
  if (found.fault != run.bit) {
    verdict.wrong.push_back(fmt::format("fault '{}', expected '{}'", found.fault, run.bit));
  }
  if (found.joints != words_of(run.joints)) {
    verdict.wrong.push_back(fmt::format("joints {}, expected {}", fmt::join(found.joints, " "),
                                        *run.joints != '\0' ? run.joints : "none"));
  }
  if (second) {
    if (second->ended() != kExitBadInput)
      verdict.wrong.emplace_back("the second one was not refused");
    printed += text_of(dir + "/second/log.txt");
  }
  if (printed.find(run.says) == std::string::npos) {
    verdict.wrong.push_back(fmt::format("its output does not say '{}'", run.says));
  }
  return verdict;
}

}  // namespace sandrunner::hil
