// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/robot/dry_run.h"

#include <fmt/format.h>

#include <array>
#include <numbers>

#include "drivers/robot/bus_plan.h"

namespace sandrunner {
namespace {

std::string words(double position_rad, double velocity_radps, double kp_nmprad, double kd_nmsprad,
                  double torque_nm) {
  return fmt::format("{:.4f} rad, {:.3f} rad/s, kp {:.2f}, kd {:.3f}, {:.3f} N m", position_rad,
                     velocity_radps, kp_nmprad, kd_nmsprad, torque_nm);
}

std::string meaning(const MitDrive& drive, const CanFrame& frame) {
  MitRequest r;
  if (decode_mit_request(drive, frame, r) != MitStatus::kOk) return "no frame of this drive";
  if (r.is_special) return r.special == MitSpecial::kEnable ? "enable" : "off";
  const MitCommand& c = r.command;
  return words(c.position_rad, c.velocity_radps, c.kp_nmprad, c.kd_nmsprad, c.torque_nm);
}

std::string meaning(const MoteusDrive& drive, const CanFrame& frame) {
  constexpr double kTurn_rad = 2.0 * std::numbers::pi;
  MoteusRequest r;
  if (decode_moteus_request(drive, frame, r) != MoteusStatus::kOk) return "no frame of this drive";
  if (r.mode == MoteusMode::kStopped) return "off";
  return fmt::format(
      "{}, at most {:.1f} N m, lets go after {:g} s",
      words(r.position_rad, r.velocity_radps, r.kp_scale * drive.kp_nmprev / kTurn_rad,
            r.kd_scale * drive.kd_nmsprev / kTurn_rad, r.torque_nm),
      r.max_torque_nm, r.watchdog_s);
}

}  // namespace

std::string candump_line(const std::string& interface, const CanFrame& frame) {
  const std::string id = fmt::format("{:0{}X}", frame.id, frame.extended ? 8 : 3);
  const std::string length =
      frame.fd ? fmt::format("[{:02}]", frame.length) : fmt::format(" [{}]", frame.length);
  std::string line = fmt::format("  {}  {}  {} ", interface, id, length);
  for (int i = 0; i < frame.length; ++i) line += fmt::format(" {:02X}", frame.data[i]);
  return line;
}

std::string dry_run(const HardwareConfig& config, const RobotDescription& robot,
                    const JointArray<JointSetPoint>& stand) {
  std::string text = plan_table(config, plan_buses(config));
  const bool gains = config.mode == DriveMode::kGains;
  if (!gains) text += "a joint at its set-point is told no torque; it gets the host's law of it\n";
  text += "each drive: off, enable, stand\n";
  for (int j = 0; j < kNumJoints; ++j) {
    const DriveConfig& drive = config.drives[j];
    const JointSetPoint point = gains ? stand[j] : JointSetPoint{};
    text += fmt::format("\n{} at {:.4f} rad\n", robot.joint_names[j], stand[j].position_rad);
    Drive sender(drive, config);
    std::array<CanFrame, 3> frames;
    sender.next_frame(nullptr, 0, frames[0]);
    sender.next_frame(&point, 0, frames[1]);
    sender.command_frame(point, frames[2]);
    for (const CanFrame& frame : frames) {
      text += fmt::format("{}   {}\n", candump_line(config.buses[drive.bus].interface, frame),
                          drive.protocol == Protocol::kMit ? meaning(drive.mit, frame)
                                                           : meaning(drive.moteus, frame));
    }
  }
  return text;
}

}  // namespace sandrunner
