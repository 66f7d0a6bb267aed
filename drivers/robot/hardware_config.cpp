// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/robot/hardware_config.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "drivers/can/mit_models.h"
#include "rt/base/errors.h"

namespace sandrunner {
namespace {

constexpr int kMostBuses = 12;
constexpr int kLeastRate_hz = 400;  // three exchanges within the gate's ceiling of an age
constexpr double kTurn_rad = 2.0 * std::numbers::pi;
// What the int16 registers of a moteus hold (moteus_frame.h): 1e-4 turns, 2.5e-4 turns/s.
constexpr double kMoteusPosition_rad = 32767 * 1e-4 * kTurn_rad;
constexpr double kMoteusSpeed_radps = 32767 * 2.5e-4 * kTurn_rad;

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
  const std::string protocol = t.choice("protocol", "", {"mit", "moteus"});
  if (protocol.empty()) {
    throw InputError(fmt::format("hardware.bus[{}] ({}): found no protocol, expected mit or moteus",
                                 before.size(), bus.interface));
  }
  bus.protocol = protocol == "mit" ? Protocol::kMit : Protocol::kMoteus;
  const bool moteus = bus.protocol == Protocol::kMoteus;
  const bool fd = t.flag("fd", moteus);
  if (moteus && !fd) {
    throw InputError(
        fmt::format("hardware.bus[{}] ({}): moteus drives speak CAN FD alone, found fd = false",
                    before.size(), bus.interface));
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

MitDrive read_mit(ConfigTree& t, const std::string& where, CanFormat format) {
  const std::string name = t.text("model", "");
  const MitModel* const model = find_mit_model(name);
  if (model == nullptr) {
    std::vector<std::string_view> names;
    for (const MitModel& m : mit_models()) names.push_back(m.name);
    throw InputError(
        fmt::format("{}: model '{}', expected one of {}", where, name, fmt::join(names, ", ")));
  }
  if (format != CanFormat::kClassic && model->variant != MitVariant::kDamiao) {
    throw InputError(fmt::format(
        "{}: {} speaks classic CAN alone, its bus is set to CAN FD (fd = true)", where, name));
  }
  MitDrive drive;
  drive.variant = model->variant;
  drive.format = format;
  drive.limits = model->limits;
  drive.reply_id = static_cast<std::uint16_t>(t.integer("reply_id", 0, 0, 0x7FE));
  // Whoever has changed them in the drive says so here.
  MitLimits& l = drive.limits;
  l.position_rad = t.number("position_rad", l.position_rad, 0.1, 1e3);
  l.velocity_radps = t.number("velocity_radps", l.velocity_radps, 0.1, 1e3);
  l.torque_nm = t.number("torque_nm", l.torque_nm, 0.1, 1e3);
  l.reply_torque_nm = t.number("reply_torque_nm", l.torque_nm, 0.1, 1e3);
  return drive;
}

MoteusDrive read_moteus(ConfigTree& t, const std::string& where, double& max_torque_nm) {
  const auto required = [&](const char* key, double most) {
    const double value = t.number(key, 0.0, 1e-6, most);
    if (value == 0.0) {
      throw InputError(
          fmt::format("{}: found no {}, expected that of the drive's configuration", where, key));
    }
    return value;
  };
  MoteusDrive drive;
  drive.kp_nmprev = required("kp_nmprev", 1e6);
  drive.kd_nmsprev = required("kd_nmsprev", 1e5);
  max_torque_nm = required("max_torque_nm", 300.0);
  return drive;
}

DriveConfig read_drive(ConfigTree& t, const std::string& joint, const HardwareConfig& hardware) {
  const std::string where = fmt::format("hardware.drive of {}", joint);
  DriveConfig drive;
  drive.bus = bus_index(hardware.buses, t.text("bus", ""), joint);
  const BusConfig& bus = hardware.buses[drive.bus];
  drive.protocol = bus.protocol;
  const auto id = static_cast<std::uint8_t>(t.integer("id", 0, 1, 126));
  if (id == 0) throw InputError(where + ": found no id, expected 1 to 126");
  if (bus.protocol == Protocol::kMit) {
    drive.mit = read_mit(t, where, bus.format);
    if (drive.mit.variant == MitVariant::kDamiao && id > 15) {
      throw InputError(
          fmt::format("{}: id {}, but a Damiao names only 1 to 15 in its replies", where, id));
    }
    drive.mit.motor_id = id;
    drive.max_torque_nm = drive.mit.limits.torque_nm;
  } else {
    drive.moteus = read_moteus(t, where, drive.max_torque_nm);
    drive.moteus.id = id;
  }
  drive.sign = static_cast<int>(t.integer("sign", 1, -1, 1));
  if (drive.sign == 0) throw InputError(where + ": sign 0, expected 1 or -1");
  drive.gear = t.number("gear", 1.0, 0.01, 100.0);
  drive.zero_rad = t.number("zero_rad", 0.0, -10.0, 10.0);
  return drive;
}

/// The fastest joint that its drive's replies can tell.
double reply_speed_radps(const DriveConfig& d) noexcept {
  const bool mit = d.protocol == Protocol::kMit;
  return (mit ? d.mit.limits.velocity_radps : kMoteusSpeed_radps) / d.gear;
}

/// What a joint may be told must be within what its drive's numbers can say.
void require_range(const DriveConfig& d, int j, const std::string& joint, double torque_scale,
                   const GateConfig& gate) {
  const auto check = [&](const char* what, double needed, double range, const char* unit) {
    if (needed <= range) return;
    throw InputError(
        fmt::format("hardware.drive of {}: {} up to {:.4g} {} needed, {:.4g} is what "
                    "the drive can be told",
                    joint, what, needed, unit, range));
  };
  const bool mit = d.protocol == Protocol::kMit;
  const MitLimits& l = d.mit.limits;
  check("torque", torque_scale * gate.torque_limit_nm[j], d.gear * d.max_torque_nm, "N m");
  check("kp", gate.kp_limit_nmprad,
        d.gear * d.gear * (mit ? l.kp_nmprad : d.moteus.kp_nmprev / kTurn_rad), "N m/rad");
  check("kd", gate.kd_limit_nmsprad,
        d.gear * d.gear * (mit ? l.kd_nmsprad : d.moteus.kd_nmsprev / kTurn_rad), "N m s/rad");
  check("speed", gate.speed_limit_radps[j], reply_speed_radps(d), "rad/s");
  const double farthest_rad = std::max(std::fabs(gate.joint_lower_rad[j] - d.zero_rad),
                                       std::fabs(gate.joint_upper_rad[j] - d.zero_rad));
  check("position", farthest_rad, (mit ? l.position_rad : kMoteusPosition_rad) / d.gear,
        "rad from its zero");
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
      if (drive.protocol == Protocol::kMit && drive.mit.reply_id == h.drives[b].id()) {
        throw InputError(fmt::format("hardware.drive of {}: reply_id {} on {} is the id of {}",
                                     robot.joint_names[a], drive.mit.reply_id, bus,
                                     robot.joint_names[b]));
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
    h.drives[j] = read_drive(t, joint, h);
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

/// Joint speed that every drive's replies can tell, with some to spare: a threshold above it would
/// never be passed.
double told_speed_radps(const HardwareConfig& h) noexcept {
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
  gate.speed_fault_radps = std::min(gate.speed_fault_radps, told_speed_radps(h));
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
  const double told_radps = told_speed_radps(h);
  if (gate.speed_fault_radps > told_radps) {
    throw InputError(
        fmt::format("controller.gate.speed_fault_radps: {} rad/s is more than the drives' replies "
                    "can tell, {:.1f}; it would never be a fault",
                    gate.speed_fault_radps, told_radps));
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

}  // namespace sandrunner
