// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/robot/dry_run.h"

#include <fmt/format.h>

#include <array>

#include "drivers/robot/bus_plan.h"

namespace sandrunner {

std::string candump_line(const std::string& interface, const CanFrame& frame) {
  const std::string id = fmt::format("{:0{}X}", frame.id, frame.extended ? 8 : 3);
  const std::string length =
      frame.fd ? fmt::format("[{:02}]", frame.length) : fmt::format(" [{}]", frame.length);
  std::string line = fmt::format("  {}  {}  {} ", interface, id, length);
  for (int i = 0; i < frame.length; ++i) line += fmt::format(" {:02X}", frame.data[i]);
  return line;
}

std::string dry_run(const HardwareConfig& config, const RobotDescription& robot,
                    const JointArray<SetPoint>& stand) {
  std::string text = plan_table(config, plan_buses(config));
  const bool gains = config.mode == DriveMode::kGains;
  if (!gains)
    text += "in torque mode the host computes the torque; a joint at its setpoint gets none\n";
  text += "each drive: off, enable, stand\n";
  for (int j = 0; j < kNumJoints; ++j) {
    const DriveConfig& drive = config.drives[j];
    const SetPoint point = gains ? stand[j] : SetPoint{};
    text += fmt::format("\n{} at {:.4f} rad\n", robot.joint_names[j], stand[j].position_rad);
    Drive sender(drive, config);
    std::array<CanFrame, 3> frames;
    sender.next_frame(nullptr, 0, frames[0]);
    sender.next_frame(&point, 0, frames[1]);
    sender.command_frame(point, frames[2]);
    for (const CanFrame& frame : frames) {
      text +=
          fmt::format("{}   {}\n", candump_line(config.buses[drive.bus].interface, frame),
                      std::visit([&](const auto& d) { return describe(d, frame); }, drive.drive));
    }
  }
  return text;
}

}  // namespace sandrunner
