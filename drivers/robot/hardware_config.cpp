// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/robot/hardware_config.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>

#include "rt/base/errors.h"

namespace sandrunner {
namespace {

constexpr int kMostBuses = 12;
constexpr int kLeastRate_hz = 400;  // three exchanges within the gate's ceiling of an age

/// The protocols of all families, with a drive of each.
template <typename... Family>
std::map<std::string, AnyDrive> families(const std::variant<Family...>&) {
  return {{Family::kProtocol, Family{}}...};
}

AnyDrive read_protocol(ConfigTree& t, const std::string& where) {
  const std::map<std::string, AnyDrive> known = families(AnyDrive{});
  std::vector<std::string> names;
  for (const auto& [name, drive] : known) names.push_back(name);
  const std::string protocol = t.choice("protocol", "", names);
  if (protocol.empty()) {
    throw InputError(
        fmt::format("{}: found no protocol, expected {}", where, fmt::join(names, " or ")));
  }
  return known.at(protocol);
}

BusConfig read_bus(ConfigTree& t, const std::vector<BusConfig>& before) {
  BusConfig bus;
  bus.interface = t.text("interface", "");
  if (bus.interface.empty()) {
    throw InputError(
        fmt::format("hardware.bus[{}]: found no interface, expected a name (can0)", before.size()));
  }
  for (const BusConfig& other : before) {
    if (other.interface == bus.interface) {
      throw InputError(fmt::format("hardware.bus[{}].interface: '{}' stands twice", before.size(),
                                   bus.interface));
    }
  }
  bus.any_drive =
      read_protocol(t, fmt::format("hardware.bus[{}] ({})", before.size(), bus.interface));
  const CanFormats formats =
      std::visit([](const auto& drive) { return can_formats(drive); }, bus.any_drive);
  const bool fd = t.flag("fd", !formats.classic);
  if (!(fd ? formats.fd : formats.classic)) {
    throw InputError(fmt::format(
        "hardware.bus[{}] ({}): {} drives speak {} alone, found fd = {}", before.size(),
        bus.interface, std::visit([](const auto& drive) { return drive.kProtocol; }, bus.any_drive),
        formats.fd ? "CAN FD" : "classic CAN", fd));
  }
  bus.format = fd ? CanFormat::kFdWithBitRateSwitch : CanFormat::kClassic;
  bus.rates.nominal_hz = t.number("bitrate_bps", bus.rates.nominal_hz, 1e4, 1e6);
  if (fd) bus.rates.data_hz = t.number("data_bitrate_bps", bus.rates.data_hz, 1e4, 8e6);
  return bus;
}

int bus_index(const std::vector<BusConfig>& buses, const std::string& name,
              const std::string& joint) {
  for (std::size_t i = 0; i < buses.size(); ++i) {
    if (buses[i].interface == name) return static_cast<int>(i);
  }
  throw InputError(
      fmt::format("hardware.drive of {}: bus '{}' is none of hardware.bus", joint, name));
}

DriveConfig read_joint_drive(ConfigTree& t, const std::string& joint,
                             const HardwareConfig& hardware) {
  const std::string where = fmt::format("hardware.drive of {}", joint);
  DriveConfig drive;
  drive.bus = bus_index(hardware.buses, t.text("bus", ""), joint);
  const BusConfig& bus = hardware.buses[drive.bus];
  const auto id = static_cast<int>(t.integer("id", 0, 1, 126));
  if (id == 0) throw InputError(where + ": found no id, expected 1 to 126");
  drive.drive = bus.any_drive;
  std::visit(
      [&](auto& d) {
        set_address(d, id, bus.format);
        read_drive(d, t, where);
      },
      drive.drive);
  drive.max_torque_nm = drive.ranges().torque_nm;
  drive.sign = static_cast<int>(t.integer("sign", 1, -1, 1));
  if (drive.sign == 0) throw InputError(where + ": sign 0, expected 1 or -1");
  drive.gear = t.number("gear", 1.0, 0.01, 100.0);
  drive.zero_rad = t.number("zero_rad", 0.0, -10.0, 10.0);
  return drive;
}

/// The fastest joint that its drive's replies can tell.
double reply_speed_radps(const DriveConfig& d) noexcept {
  return d.ranges().velocity_radps / d.gear;
}

/// What a joint may be told must be within what its drive's numbers can say.
void require_range(const DriveConfig& d, int j, const std::string& joint, double torque_scale,
                   const GateConfig& gate) {
  const auto check = [&](const char* what, double needed, double range, const char* unit) {
    if (needed <= range) return;
    throw InputError(
        fmt::format("hardware.drive of {}: {} up to {:.4g} {} needed, {:.4g} is what "
                    "a command to the drive can express",
                    joint, what, needed, unit, range));
  };
  const DriveRanges ranges = d.ranges();
  check("torque", torque_scale * gate.torque_limit_nm[j], d.gear * d.max_torque_nm, "N m");
  check("kp", gate.kp_limit_nmprad, d.gear * d.gear * ranges.kp_nmprad, "N m/rad");
  check("kd", gate.kd_limit_nmsprad, d.gear * d.gear * ranges.kd_nmsprad, "N m s/rad");
  check("speed", gate.speed_limit_radps[j], reply_speed_radps(d), "rad/s");
  const double farthest_rad = std::max(std::fabs(gate.joint_lower_rad[j] - d.zero_rad),
                                       std::fabs(gate.joint_upper_rad[j] - d.zero_rad));
  check("position", farthest_rad, ranges.position_rad / d.gear, "rad from its zero");
}

void require_one_id_each(const HardwareConfig& h, const RobotDescription& robot) {
  for (int a = 0; a < kNumJoints; ++a) {
    for (int b = 0; b < kNumJoints; ++b) {
      const DriveConfig& drive = h.drives[a];
      if (drive.bus != h.drives[b].bus) continue;
      const std::string& bus = h.buses[drive.bus].interface;
      if (b < a && drive.id() == h.drives[b].id()) {
        throw InputError(fmt::format("hardware.drive of {}: id {} on {} is that of {}",
                                     robot.joint_names[a], drive.id(), bus, robot.joint_names[b]));
      }
      // Its replies would be commands to the other.
      const std::optional<std::uint32_t> reply =
          std::visit([](const auto& d) { return reply_id(d); }, drive.drive);
      if (reply && static_cast<int>(*reply) == h.drives[b].id()) {
        throw InputError(fmt::format("hardware.drive of {}: reply_id {} on {} is the id of {}",
                                     robot.joint_names[a], *reply, bus, robot.joint_names[b]));
      }
    }
  }
}

void read_drives(ConfigTree& config, const RobotDescription& robot, const GateConfig& gate,
                 HardwareConfig& h) {
  std::array<bool, kNumJoints> seen{};
  for (ConfigTree& t : config.tables("hardware.drive")) {
    const std::string joint = t.text("joint", "");
    const auto found = std::find(robot.joint_names.begin(), robot.joint_names.end(), joint);
    if (found == robot.joint_names.end()) {
      throw InputError(fmt::format("hardware.drive: joint '{}', expected one of {}", joint,
                                   fmt::join(robot.joint_names, ", ")));
    }
    const auto j = static_cast<int>(found - robot.joint_names.begin());
    if (seen[j]) throw InputError(fmt::format("hardware.drive: joint {} stands twice", joint));
    seen[j] = true;
    h.drives[j] = read_joint_drive(t, joint, h);
    require_range(h.drives[j], j, joint, h.torque_scale, gate);
  }
  for (int j = 0; j < kNumJoints; ++j) {
    if (seen[j]) continue;
    throw InputError(fmt::format("hardware.drive: found none of joint {}", robot.joint_names[j]));
  }
  require_one_id_each(h, robot);
}

ImuConfig read_imu(ConfigTree& config) {
  ImuConfig imu;
  const bool mip = config.choice("hardware.imu.protocol", "mip", {"mip", "xsens"}) == "mip";
  imu.protocol = mip ? ImuProtocol::kMip : ImuProtocol::kXsens;
  imu.device = config.text("hardware.imu.device", "");
  if (imu.device.empty()) {
    throw InputError("hardware.imu.device: found none, expected a serial line (/dev/ttyS0)");
  }
  imu.baud = static_cast<unsigned>(config.integer("hardware.imu.baud", imu.baud, 9600, 4'000'000));
  imu.rate_hz =
      static_cast<int>(config.integer("hardware.imu.rate_hz", mip ? 500 : 400, 100, 1000));
  imu.quaternion_rate_hz = static_cast<int>(
      config.integer("hardware.imu.quaternion_rate_hz", std::min(imu.rate_hz, 500), 100, 1000));
  const std::vector<double> rpy_deg =
      config.numbers("hardware.imu.mounting_rpy_deg", {0.0, 0.0, 0.0}, 3, -360.0, 360.0);
  Vector3 rpy_rad;
  for (int i = 0; i < 3; ++i) rpy_rad[i] = rpy_deg[i] * std::numbers::pi / 180.0;
  imu.mounting = ImuMounting::from_rpy(rpy_rad);
  check(imu);
  return imu;
}

StopLineConfig read_emergency_stop(ConfigTree& config) {
  StopLineConfig stop;
  stop.chip = config.text("hardware.emergency_stop.chip", "");
  if (stop.chip.empty()) return stop;
  if (!config.has("hardware.emergency_stop.line")) {
    throw InputError(
        fmt::format("hardware.emergency_stop.line: found none, expected the number of a line of {}",
                    stop.chip));
  }
  stop.line = static_cast<int>(config.integer("hardware.emergency_stop.line", 0, 0, 1023));
  return stop;
}

}  // namespace

HardwareConfig read_hardware_config(ConfigTree& config, const RobotDescription& robot,
                                    const GateConfig& gate) {
  HardwareConfig h;
  h.mode = config.choice("hardware.mode", "gains", {"gains", "torque"}) == "gains"
               ? DriveMode::kGains
               : DriveMode::kTorque;
  h.rate_hz =
      static_cast<int>(config.integer("hardware.rate_hz", h.rate_hz, kLeastRate_hz, kControlHz));
  if (kControlHz % h.rate_hz != 0) {
    throw InputError(
        fmt::format("hardware.rate_hz: {}, expected a whole part of {} (4000, 2000, "
                    "1000, 800, 500, ...)",
                    h.rate_hz, kControlHz));
  }
  // A drive that closes no loop holds its last torque until then.
  const double longest_s = h.mode == DriveMode::kTorque ? 0.05 : 0.1;
  h.drive_timeout_s =
      config.number("hardware.drive_timeout_s", h.drive_timeout_s, 0.005, longest_s);
  h.timeout_unverified = config.flag("hardware.timeout_unverified", false);
  h.temperature_limit_degc =
      config.number("hardware.temperature_limit_degc", h.temperature_limit_degc, 0.0, 150.0);
  h.voltage_low_v = config.number("hardware.voltage_low_v", h.voltage_low_v, 0.0, 1e3);
  h.voltage_high_v = config.number("hardware.voltage_high_v", h.voltage_high_v, 0.0, 1e3);
  if (h.voltage_low_v > h.voltage_high_v) {
    throw InputError(fmt::format("hardware.voltage_low_v: {} is above hardware.voltage_high_v, {}",
                                 h.voltage_low_v, h.voltage_high_v));
  }
  h.torque_scale = config.number("hardware.torque_scale", h.torque_scale, 0.0, 1.0);
  h.hanging = config.flag("hardware.hanging", false);
  for (ConfigTree& bus : config.tables("hardware.bus")) {
    h.buses.push_back(read_bus(bus, h.buses));
  }
  if (h.buses.empty() || h.buses.size() > kMostBuses) {
    throw InputError(
        fmt::format("hardware.bus: found {} buses, expected 1 to {}", h.buses.size(), kMostBuses));
  }
  read_drives(config, robot, gate, h);
  h.imu = read_imu(config);
  h.emergency_stop = read_emergency_stop(config);
  return h;
}

namespace {

/// Joint speed that the replies of every drive can report, with a margin: a threshold above it
/// would never be passed.
double reportable_speed_radps(const HardwareConfig& h) noexcept {
  double most = std::numeric_limits<double>::infinity();
  for (const DriveConfig& drive : h.drives) most = std::min(most, 0.98 * reply_speed_radps(drive));
  return most;
}

}  // namespace

void fit_gate_to(const HardwareConfig& h, GateConfig& gate) noexcept {
  const auto ticks = static_cast<std::uint64_t>(h.ticks_per_exchange());
  // A value is sent for in one exchange, comes in the ticks up to the next one, and may be lost:
  // two losses in a row are a fault.
  gate.joints_limit_ticks = std::max(gate.joints_limit_ticks, ticks + 2);
  gate.joints_fault_ticks = std::max(gate.joints_fault_ticks, 3 * ticks);
  const auto imu_ticks = static_cast<std::uint64_t>(kControlHz / h.imu.rate_hz);
  gate.imu_limit_ticks = std::max(gate.imu_limit_ticks, imu_ticks + 4);
  gate.imu_fault_ticks = std::max(gate.imu_fault_ticks, 3 * imu_ticks);
  for (double& limit_nm : gate.torque_limit_nm) limit_nm *= h.torque_scale;
  gate.speed_fault_radps = std::min(gate.speed_fault_radps, reportable_speed_radps(h));
  gate.hanging = h.hanging;
}

void fit_drives_to(const GateConfig& gate, HardwareConfig& h) {
  // Between two commands lie what the loop may miss and the rest of an exchange.
  const double stall_s = kControlPeriod_s * (static_cast<double>(gate.stall_fault_ticks) +
                                             static_cast<double>(h.ticks_per_exchange()));
  if (h.drive_timeout_s <= stall_s) {
    throw InputError(
        fmt::format("hardware.drive_timeout_s: {}, expected more than the {} s that the loop may "
                    "miss and an exchange takes (controller.gate.stall_fault_ticks)",
                    h.drive_timeout_s, stall_s));
  }
  const double reportable_radps = reportable_speed_radps(h);
  if (gate.speed_fault_radps > reportable_radps) {
    throw InputError(
        fmt::format("controller.gate.speed_fault_radps: {} rad/s is more than the drives' replies "
                    "can report, {:.1f}; it would never be a fault",
                    gate.speed_fault_radps, reportable_radps));
  }
  for (int j = 0; j < kNumJoints; ++j) {
    DriveConfig& drive = h.drives[j];
    drive.max_torque_nm = std::min(drive.max_torque_nm, gate.torque_limit_nm[j] / drive.gear);
  }
}

std::vector<std::string> unguarded(const HardwareConfig& config) {
  std::vector<std::string> lines;
  if (config.emergency_stop.chip.empty()) {
    lines.emplace_back("no emergency stop is configured: hardware.emergency_stop.chip is not set");
  }
  const HardwareConfig open;
  if (config.voltage_low_v <= open.voltage_low_v && config.voltage_high_v >= open.voltage_high_v) {
    lines.emplace_back(
        "the supply voltage is not judged: hardware.voltage_low_v and .voltage_high_v are not set");
  }
  return lines;
}

std::string drive_name(const HardwareConfig& hardware, const RobotDescription& robot, int joint) {
  const DriveConfig& drive = hardware.drives[joint];
  return fmt::format("{} ({} id {})", robot.joint_names[joint], hardware.buses[drive.bus].interface,
                     drive.id());
}

}  // namespace sandrunner
