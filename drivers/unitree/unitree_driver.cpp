// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/unitree/unitree_driver.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "drivers/unitree/unitree_check.h"
#include "drivers/unitree/unitree_robot.h"
#include "rt/base/errors.h"

namespace sandrunner {

UnitreeDriver::UnitreeDriver(const UnitreeConfig& config, const RobotDescription& robot)
    : config_(config), description_(robot) {}

UnitreeDriver::UnitreeDriver(ConfigTree& config, const RobotDescription& robot,
                             const GateConfig& /*limits*/)
    : UnitreeDriver(read_unitree_config(config), robot) {}

void UnitreeDriver::fit_gate(GateConfig& gate) const noexcept { fit_gate_to(config_, gate); }

void UnitreeDriver::fit_to(const ControllerConfig& controller) {
  robot_ = unitree::figures_of(description_, controller.gate, controller.damping.kd_nmsprad);
}

int UnitreeDriver::check(const CheckTask& task) const {
  if (task.plan || task.move || task.nudge || task.zero_pose_rad) {
    throw InputError(
        fmt::format("check: {}: found hardware.kind \"unitree\", expected \"can\" with --plan, "
                    "--move, --nudge or --zero",
                    task.path));
  }
  return run_unitree_check(config_, robot_);
}

void UnitreeDriver::fork_processes() {
  wire_ = std::make_unique<unitree::WireProcess>(config_, robot_);
}

std::unique_ptr<RobotIo> UnitreeDriver::connect() {
  if (!wire_) fork_processes();
  wire_->connect();
  return std::make_unique<UnitreeRobot>(config_, std::move(wire_));
}

std::vector<std::string> UnitreeDriver::warnings() const {
  std::vector<std::string> lines;
  if (!config_.need_remote) {
    lines.emplace_back(
        "a remote that is off or lost is no emergency stop: hardware.unitree.need_remote is false");
  }
  return lines;
}

std::string UnitreeDriver::dry_run(const StandConfig& stand) const {
  const auto mode = static_cast<std::uint8_t>(config_.motor_mode);
  unitree::LowCmd command;
  std::string text = fmt::format("{} on {}, domain {}, 500 times a second\n",
                                 unitree::kCommandTopic, config_.interface, config_.domain);
  unitree::encode_off(command);
  text += fmt::format("off: all motors in mode 0, CRC {:08X}\n", command.crc);
  unitree::encode_damping(mode, robot_.damping_kd_nmsprad, command);
  text += fmt::format("damping: mode {}, kd {:.3f}, CRC {:08X}\n", config_.motor_mode,
                      fmt::join(robot_.damping_kd_nmsprad, ", "), command.crc);
  JointCommand joints;
  joints.position_rad = stand.nominal_rad;
  joints.kp_nmprad.fill(stand.kp_nmprad);
  joints.kd_nmsprad.fill(stand.kd_nmsprad);
  unitree::encode_joints(mode, joints, 0, command);
  text += fmt::format("stand: mode {}, kp {:.3f}, kd {:.3f}, CRC {:08X}\n", config_.motor_mode,
                      stand.kp_nmprad, stand.kd_nmsprad, command.crc);
  for (int j = 0; j < kNumJoints; ++j) {
    const int motor = unitree::motor_of(j);
    text += fmt::format("  motor_cmd[{:>2}]  {:<14} q {:8.4f}\n", motor, robot_.joint_names[j],
                        command.motor_cmd[motor].q);
  }
  return text;
}

std::string UnitreeDriver::report(const RobotIo& io) const {
  const auto& robot = static_cast<const UnitreeRobot&>(io);
  const unitree::WireMemory& memory = robot.wire().memory();
  const unitree::StateCounters& states = robot.newest().counters;
  std::string text =
      fmt::format("{}: {} commands sent", unitree::kCommandTopic, memory.sent.load());
  if (memory.not_sent > 0) text += fmt::format(", {} NOT SENT", memory.not_sent.load());
  if (memory.foreign) {
    text += fmt::format(", ANOTHER PROGRAM COMMANDS THE ROBOT ({} commands)",
                        memory.foreign_commands.load());
  }
  if (!memory.real_time) text += ", without real-time priority";
  text += fmt::format("\n{}: {} states", unitree::kStateTopic, states.taken);
  const auto add = [&](std::uint64_t count, const char* what) {
    if (count > 0) text += fmt::format(", {} {}", count, what);
  };
  add(states.without_crc, "without a CRC");
  add(states.bad_crc, "with a WRONG CRC");
  add(states.not_finite, "NOT FINITE");
  add(states.repeated, "REPEATED");
  add(states.old, "with a clock that WENT BACK");
  const unitree::RobotState& state = robot.newest().state;
  const auto hottest = std::ranges::max_element(state.temperature_degc);
  text += fmt::format(
      "\nbattery {} %, {:.1f} V; hottest motor {} degrees C ({})\n", state.battery_percent,
      state.supply_v, *hottest,
      robot_.joint_names[static_cast<std::size_t>(hottest - state.temperature_degc.begin())]);
  for (int j = 0; j < kNumJoints; ++j) {
    const std::string words = unitree_fault_words(robot.faults()[j]);
    if (robot.lost(j) == 0 && words.empty()) continue;
    text += fmt::format("{}: {} messages lost by the robot's own bus{}{}\n", robot_.joint_names[j],
                        robot.lost(j), words.empty() ? "" : "; ", words);
  }
  return text;
}

}  // namespace sandrunner
