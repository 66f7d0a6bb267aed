// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/fault_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "tools/hil/diagnosis.h"

namespace sandrunner::hil {
namespace {

constexpr std::size_t kFaultyJoint = 2;

std::string within(double time_s) {
  return time_s > 0.0 ? fmt::format("{:.0f} ms", 1e3 * time_s) : "-";
}

}  // namespace

std::vector<std::string> FaultRun::faults_of(const RobotDescription& robot) const {
  std::vector<std::string> faults;
  std::istringstream script(fault);
  for (std::string line; std::getline(script >> std::ws, line, ';');) {
    faults.push_back(fmt::format(fmt::runtime(line), robot.joint_names[kFaultyJoint]));
  }
  return faults;
}

std::set<std::string> FaultRun::joints_of(const RobotDescription& robot) const {
  const std::string text = joints;
  if (text == kAllJoints) return {robot.joint_names.begin(), robot.joint_names.end()};
  if (text == kThatJoint) return {robot.joint_names[kFaultyJoint]};
  return words_of(text);
}

std::string fault_run_markdown(std::span<const FaultRun> runs) {
  // Where each drive has a time-out of its own, some hear nothing any more.
  const bool some_unreachable =
      std::ranges::any_of(runs, [](const FaultRun& run) { return run.passive_within_s > 0.0; });
  std::string table = fmt::format(
      "| what goes wrong | fault | joints named | then | {} | exit code |\n|---|---|---|---|---|{}"
      "---|\n",
      some_unreachable ? "drives that hear: damped within | all drives passive within"
                       : "damped within",
      some_unreachable ? "---|" : "");
  for (const FaultRun& run : runs) {
    if (run.nothing_goes_wrong()) continue;
    table += fmt::format("| {} | {} | {} | {} | {} | {}{} |\n", run.what,
                         *run.bit != '\0'     ? fmt::format("`{}`", run.bit)
                         : run.exit_code == 2 ? "refused at the start"
                                              : "none",
                         run.joints, run.then, within(run.damped_within_s),
                         some_unreachable ? within(run.passive_within_s) + " | " : "",
                         run.exit_code < 0 ? "-" : fmt::format("{}", run.exit_code));
  }
  return table;
}

}  // namespace sandrunner::hil
