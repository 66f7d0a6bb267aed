// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/robot/can_driver.h"

#include <algorithm>
#include <utility>

#include "drivers/robot/can_robot.h"
#include "drivers/robot/dry_run.h"
#include "drivers/robot/hardware_fit.h"

namespace sandrunner {

CanDriver::CanDriver(HardwareConfig config, RobotDescription robot, const GateConfig& gate)
    : config_(std::move(config)), robot_(std::move(robot)), gate_(gate) {}

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
  JointArray<JointSetPoint> points;
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
