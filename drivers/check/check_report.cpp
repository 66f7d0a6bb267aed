// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/check/check_report.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "drivers/robot/bus_plan.h"

namespace sandrunner {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

/// The joint whose drive has this place, -1: none.
int joint_of(const HardwareConfig& config, std::size_t bus, int id) {
  for (int j = 0; j < kNumJoints; ++j) {
    const DriveConfig& drive = config.drives[j];
    if (drive.bus == static_cast<int>(bus) && drive.id() == id) return j;
  }
  return -1;
}

std::string number_or_dash(double value, int decimals) {
  return std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, decimals);
}

std::string scan_table(const HardwareConfig& config, const CheckFindings& findings) {
  std::string text = fmt::format("bus           ids that answer, of 1 to {}\n", kMostScannedId);
  for (std::size_t b = 0; b < config.buses.size(); ++b) {
    std::string ids;
    for (const ScannedDrive& drive : findings.scanned[b]) ids += fmt::format("{} ", drive.id);
    text += fmt::format("{:<14}{}\n", config.buses[b].interface, ids.empty() ? "none" : ids);
  }
  return text;
}

}  // namespace

std::vector<std::string> scan_problems(const HardwareConfig& config, const RobotDescription& robot,
                                       const std::vector<std::vector<ScannedDrive>>& scanned) {
  std::vector<std::string> problems;
  for (std::size_t b = 0; b < scanned.size(); ++b) {
    const std::string& bus = config.buses[b].interface;
    for (const ScannedDrive& drive : scanned[b]) {
      const int j = joint_of(config, b, drive.id);
      if (j < 0) {
        problems.push_back(fmt::format(
            "{} id {}: a drive answers that no joint has; look at hardware.drive", bus, drive.id));
        continue;
      }
      const DriveConfig& configured = config.drives[j];
      const std::optional<std::uint32_t> expected =
          std::visit([](const auto& d) { return reply_id(d); }, configured.drive);
      if (!expected || *expected == drive.reply_id) continue;
      problems.push_back(fmt::format("{} ({} id {}): answers under identifier {}, reply_id is {}",
                                     robot.joint_names[j], bus, drive.id, drive.reply_id,
                                     *expected));
    }
  }
  return problems;
}

std::vector<std::string> bus_problems(const HardwareConfig& config,
                                      const std::vector<FoundBus>& buses) {
  std::vector<std::string> problems;
  for (std::size_t b = 0; b < buses.size(); ++b) {
    const FoundBus& bus = buses[b];
    const std::string& name = config.buses[b].interface;
    if (bus.not_sent > 0) {
      problems.push_back(
          fmt::format("{}: {} frames were not taken: is it up, is anybody on the bus, do the bit "
                      "rates match (ip -details link show {})",
                      name, bus.not_sent, name));
    }
    if (bus.error_frames > 0) {
      problems.push_back(
          fmt::format("{}: {} error frames, last: {}; look at termination, cable and bit rates",
                      name, bus.error_frames, bus.error.empty() ? "of no known kind" : bus.error));
    }
    if (bus.foreign > 0) {
      problems.push_back(
          fmt::format("{}: {} frames that are no reply of a configured drive", name, bus.foreign));
    }
  }
  return problems;
}

std::vector<std::string> imu_problems(const ImuConfig& config, const ImuFindings& findings) {
  std::vector<std::string> problems = imu_problems(findings.figures, config.rate_hz);
  if (findings.bad_packets > 0) {
    problems.push_back(
        fmt::format("{} packets with a bad checksum, repeated or incomplete: look at its line",
                    findings.bad_packets));
  }
  for (std::string& problem : problems) problem = fmt::format("IMU {}: {}", config.device, problem);
  return problems;
}

std::string joint_table(const HardwareConfig& config, const RobotDescription& robot,
                        const GateConfig& gate, const JointArray<FoundDrive>& drives) {
  std::string text =
      "joint         bus         id   answers  mean, max ms   position rad (stops)      "
      "degC   V     fault\n";
  for (int j = 0; j < kNumJoints; ++j) {
    const DriveConfig& drive = config.drives[j];
    const FoundDrive& d = drives[j];
    const std::string stops =
        fmt::format("({:.2f} to {:.2f})", gate.joint_lower_rad[j], gate.joint_upper_rad[j]);
    text += fmt::format("{:<14}{:<10}{:>4} {:>9}", robot.joint_names[j],
                        config.buses[drive.bus].interface, drive.id(),
                        fmt::format("{}/{}", d.replies, d.requests));
    if (d.replies == 0) {
      text += d.requests == 0 ? "  not looked at: its bus is not there\n" : "  silent\n";
      continue;
    }
    text += fmt::format("  {:>5.2f} {:>5.2f}   {:>8.4f} {:<17}{:>5} {:>5}     {}\n",
                        1e3 * d.round_trip_s, 1e3 * d.longest_round_trip_s, d.position_rad, stops,
                        number_or_dash(d.temperature_degc, 0), number_or_dash(d.voltage_v, 1),
                        d.fault == 0 ? "none" : drive_fault_words(drive, d.fault));
  }
  return text;
}

std::string imu_line(const ImuConfig& config, const ImuFindings& findings) {
  const ImuFigures& f = findings.figures;
  const Vector3 &a = f.acceleration_mps2, &w = f.angular_velocity_radps;
  return fmt::format(
      "IMU {}: {}, {:.1f} of {} samples/s, |a| {:.3f} m/s^2, up {:.1f} degrees from body z, gyro "
      "at rest ({:.4f}, {:.4f}, {:.4f}) rad/s\n",
      config.device, findings.state, f.rate_hz, config.rate_hz, length(a), kDegrees * f.tilt_rad,
      w[0], w[1], w[2]);
}

std::string check_report(const HardwareConfig& config, const RobotDescription& robot,
                         const GateConfig& gate, const CheckFindings& findings) {
  std::string text = plan_table(config, plan_buses(config)) + "\n";
  if (!findings.scanned.empty()) {
    text += scan_table(config, findings) + "\n";
    text += joint_table(config, robot, gate, findings.drives) + "\n";
  }
  if (findings.imu) text += imu_line(config.imu, *findings.imu) + "\n";
  text += findings.emergency_stop + "\n\n";
  if (!findings.moves.empty()) {
    text += "turned by hand\n";
    for (const std::string& move : findings.moves) text += "  " + move + "\n";
    text += "\n";
  }
  if (!findings.nudges.empty()) {
    text += "pushed by its own drive\n";
    for (const std::string& nudge : findings.nudges) text += "  " + nudge + "\n";
    text += "\n";
  }
  const char* const power = findings.powered ? "the drives are off again" : "nothing was powered";
  if (findings.problems.empty()) return text + fmt::format("nothing is wrong; {}\n", power);
  text += fmt::format("{} wrong; {}\n",
                      findings.problems.size() == 1
                          ? "1 thing is"
                          : fmt::format("{} things are", findings.problems.size()),
                      power);
  for (const std::string& problem : findings.problems) text += "  " + problem + "\n";
  return text;
}

}  // namespace sandrunner
