// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/can_driver.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "drivers/check/check.h"
#include "drivers/robot/bus_plan.h"
#include "drivers/robot/can_robot.h"
#include "drivers/robot/dry_run.h"
#include "drivers/robot/hardware_fit.h"
#include "rt/base/errors.h"

namespace sandrunner {

CanDriver::CanDriver(ConfigTree& config, const RobotDescription& robot, const GateConfig& limits)
    : config_(read_hardware_config(config, robot, limits)), robot_(robot) {}

void CanDriver::fit_gate(GateConfig& gate) const noexcept { fit_gate_to(config_, gate); }

void CanDriver::fit_to(const ControllerConfig& controller) {
  gate_ = controller.gate;
  fit_drives_to(gate_, config_);
}

int CanDriver::check(const CheckTask& task) const {
  if (!task.plan) {
    const auto read = [&](const std::string& text) {
      return dynamic_cast<const CanDriver&>(*task.read(text)).config();
    };
    return run_check(
        {.task = task, .config = config_, .robot = robot_, .gate = gate_, .read = read});
  }
  const std::vector<PlannedBus> plan = plan_buses(config_);
  fmt::print("{}", plan_table(config_, plan));
  const bool fits = std::ranges::none_of(plan, &PlannedBus::overloaded);
  return fits ? kExitOk : kExitFailed;
}

void CanDriver::fork_processes() {
  const OffFrames off = off_frames(config_, true);
  if (std::ranges::all_of(off, &std::vector<CanFrame>::empty)) return;
  guard_ = std::make_unique<CanGuard>(off, config_.drive_timeout_s, open_buses_of(config_));
}

std::unique_ptr<RobotIo> CanDriver::connect() {
  if (!guard_) fork_processes();
  return std::make_unique<CanRobot>(config_, robot_, gate_, std::move(guard_));
}

std::vector<std::string> CanDriver::warnings() const { return unguarded(config_); }

std::string CanDriver::dry_run(const StandConfig& stand) const {
  JointArray<SetPoint> points;
  for (int j = 0; j < kNumJoints; ++j) {
    points[j] = {.position_rad = stand.nominal_rad[j],
                 .kp_nmprad = stand.kp_nmprad,
                 .kd_nmsprad = stand.kd_nmsprad};
  }
  return sandrunner::dry_run(config_, robot_, points);
}

std::string CanDriver::report(const RobotIo& robot) const {
  return hardware_report(static_cast<const CanRobot&>(robot), config_, robot_);
}

}  // namespace sandrunner
