// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/bench.h"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <utility>

#include "drivers/can_driver.h"
#include "drivers/unitree/unitree_driver.h"
#include "rt/base/clock_ns.h"
#include "tools/hil/can_link.h"
#include "tools/hil/controller_process.h"
#include "tools/hil/unitree_link.h"

namespace sandrunner::hil {
namespace {

constexpr std::int64_t kQuestion_ns = 10'000'000;

std::unique_ptr<Link> make_link(const ProcessConfig& config, const sim::Simulator& robot,
                                const std::string& imu_device, std::span<const TimedFault> script) {
  if (const auto* const can = dynamic_cast<const CanDriver*>(config.driver.get())) {
    return std::make_unique<CanLink>(can->config(), config.robot.description, robot, imu_device,
                                     script);
  }
  return std::make_unique<UnitreeLink>(dynamic_cast<const UnitreeDriver&>(*config.driver).config(),
                                       config.robot, config.simulator, script);
}

/// On its belly.
std::unique_ptr<sim::Simulator> lying_robot(const ProcessConfig& config) {
  sim::SimulatorConfig bounded = config.simulator;
  // One that lies on base, knees and feet would take longer than a tick on the emulated machine.
  bounded.step.max_sweeps = std::min(bounded.step.max_sweeps, 20);
  auto robot = std::make_unique<sim::Simulator>(config.robot, bounded);
  robot->reset_lying();
  return robot;
}

Place place_of(const sim::Simulator& robot) {
  const sim::Vec3<double>& position = robot.state().robot.rigid.position;
  return {position.x, position.y};
}

constexpr auto kProcessFaults = std::to_array<FaultKind>({
    {"kill", Takes::kNothing, "SIGKILL to the controller"},
    {"crash", Takes::kNothing, "SIGSEGV to the controller"},
    {"stop", Takes::kNothing, "SIGSTOP to the controller"},
    {"hang", Takes::kNothing, "the controller's control thread stops"},
    {"wire-kill", Takes::kNothing, "SIGKILL to the process of a Unitree robot's wire"},
    {"second", Takes::kNothing, "a second controller starts"},
});

void make_process_fault(const std::string& kind, pid_t controller,
                        const std::function<void()>& second) {
  if (controller <= 0) return;
  if (kind == "kill") kill(controller, SIGKILL);
  if (kind == "crash") kill(controller, SIGSEGV);
  if (kind == "stop") kill(controller, SIGSTOP);
  if (kind == "hang") stop_thread(controller, "control");
  if (kind == "wire-kill") {
    if (const pid_t wire = child_of(child_of(controller)); wire > 0) kill(wire, SIGKILL);
  }
  if (kind == "second" && second) second();
}

/// Those of a link and those of the controller's process.
template <typename L>
std::vector<FaultKind> all_kinds() {
  std::vector<FaultKind> kinds(L::faults().begin(), L::faults().end());
  kinds.insert(kinds.end(), kProcessFaults.begin(), kProcessFaults.end());
  return kinds;
}

}  // namespace

std::string fault_kinds_help() {
  const auto lines = [](const auto& kinds) {
    std::string text;
    for (const FaultKind& kind : kinds) text += fmt::format("  {:<14} {}\n", kind.name, kind.help);
    return text;
  };
  return "Kinds of faults:\n" + lines(CanLink::faults()) + "Of a Unitree robot:\n" +
         lines(UnitreeLink::faults()) + "Of the controller (runs only):\n" + lines(kProcessFaults);
}

std::vector<TimedFault> read_faults(const ProcessConfig& config,
                                    const std::vector<std::string>& texts) {
  const auto* const can = dynamic_cast<const CanDriver*>(config.driver.get());
  FaultWords words{.kinds = can ? all_kinds<CanLink>() : all_kinds<UnitreeLink>(),
                   .joints = config.robot.description.joint_names,
                   .buses = {}};
  if (can) {
    for (const BusConfig& bus : can->config().buses) words.buses.push_back(bus.interface);
  }
  std::vector<TimedFault> faults;
  for (const std::string& text : texts) faults.push_back(read_fault(text, words));
  return faults;
}

Bench::Bench(const ProcessConfig& config, const std::string& imu_device,
             std::vector<TimedFault> script, double walk_s)
    : robot_(lying_robot(config)),
      link_(make_link(config, *robot_, imu_device, script)),
      faults_(std::move(script)),
      board_(1e-9 * static_cast<double>(link_->cycle_ns()), walk_s,
             config.controller.walk.kp_nmprad, place_of(*robot_)) {}

BenchReport Bench::play(const std::function<bool()>& more, pid_t controller,
                        const std::function<void()>& second) {
  BenchReport report;
  const std::int64_t cycle_ns = link_->cycle_ns(), start_ns = clock_ns(CLOCK_MONOTONIC);
  link_->begin(start_ns);
  std::int64_t time_ns = 0;
  while (time_ns % kQuestion_ns != 0 || more()) {
    time_ns += cycle_ns;
    const double now_s = link_->exchange(start_ns + time_ns);
    while (const TimedFault* const fault = faults_.due(now_s, board_.enabled_at_s())) {
      if (!link_->make(*fault, now_s)) make_process_fault(fault->kind, controller, second);
      board_.fault_made(fault->text, now_s);
    }
    const JointArray<DriveMoment>& drives = link_->step(now_s, *robot_);
    board_.note(now_s, drives, place_of(*robot_), robot_->report().base_contact > 0.0);
    report.late_longest_s =
        std::max(report.late_longest_s, link_->now_s() - 1e-9 * static_cast<double>(time_ns));
  }
  report.time_s = 1e-9 * static_cast<double>(time_ns);
  report.score = board_.score();
  report.link = link_->figures(report.score.enabled_at_s.has_value());
  return report;
}

}  // namespace sandrunner::hil
