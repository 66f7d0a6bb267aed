// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/robot/hardware_config.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "rt/base/errors.h"

namespace sandrunner {
namespace {

constexpr int kMostBuses = 12;
constexpr int kLeastRate_hz = 400;  // three exchanges within the gate's ceiling of an age

constexpr const char* kModes[] = {"gains", "torque"};      // in the order of DriveMode
constexpr const char* kImuProtocols[] = {"mip", "xsens"};  // in the order of ImuProtocol

using H = HardwareConfig;
constexpr Setting<H> kExchange[] = {
    {"mode", words<&H::mode>(kModes),
     "gains: the drive closes the joint's loop; torque: this program does."},
    {"rate_hz", &H::rate_hz, kLeastRate_hz, kControlHz,
     "Exchanges with every drive; a divisor of 4000."},
};
// A drive that closes no loop holds its last torque until then.
constexpr Setting<H> drive_timeout(DriveMode mode) {
  return {"drive_timeout_s",
          &H::drive_timeout_s,
          0.005,
          mode == DriveMode::kTorque ? 0.05 : 0.1,
          "Without a command for this long a drive gives no torque.",
          nullptr,
          "0.005 to 0.1; torque: to 0.05"};
}
constexpr Setting<H> kGuards[] = {
    {"timeout_unverified", &H::timeout_unverified,
     "Trust that drives which cannot report their time-out have this one."},
    {"temperature_limit_degc", &H::temperature_limit_degc, 0.0, 150.0,
     "Warning: a drive is hotter. Fault: by 10 degrees."},
    {"voltage_low_v", &H::voltage_low_v, 0.0, 1e3,
     "Warning: a drive's supply is lower. Fault: by 5 %."},
    {"voltage_high_v", &H::voltage_high_v, 0.0, 1e3,
     "Warning: a drive's supply is higher. Fault: by 5 %."},
};
constexpr Setting<H> kFirstWalks[] = {
    {"torque_scale", &H::torque_scale, 0.0, 1.0, "Factor of every torque limit, for first walks."},
    {"hanging", &H::hanging,
     "The robot hangs in a frame: tilt, free fall, zeros at arm and joints that all stay the same "
     "are not judged; Walk is refused."},
};

// Keys of a bus and of a drive that are not members of BusConfig and DriveConfig as they stand.
struct BusKeys {
  std::string interface, protocol;
  bool fd = false;
};
constexpr Setting<BusKeys> kInterface[] = {
    {"interface", &BusKeys::interface, "Name of the CAN interface (can0).", kRequired},
};
constexpr Setting<BusKeys> kProtocol[] = {
    {"protocol", &BusKeys::protocol, "Family of the drives on the bus.", kRequired},
};
constexpr Setting<BusKeys> kFd[] = {
    {"fd", &BusKeys::fd, "CAN FD with bit rate switch.", "false; moteus: true"},
};
constexpr Setting<BusRates> kNominalRate[] = {
    {"bitrate_bps", &BusRates::nominal_hz, 1e4, 1e6,
     "Bit rate of the interface, for the bus load."},
};
constexpr Setting<BusRates> kDataRate[] = {
    {"data_bitrate_bps", &BusRates::data_hz, 1e4, 8e6,
     "Bit rate of CAN FD's data phase, for the bus load."},
};

struct DriveKeys {
  std::string joint, bus;
  int id = 0;
};
constexpr Setting<DriveKeys> kDrive[] = {
    {"joint", &DriveKeys::joint, "Joint that the drive moves, as the URDF names it.", kRequired},
    {"bus", &DriveKeys::bus, "Interface of one of hardware.bus.", kRequired},
    {"id", &DriveKeys::id, 1, 126, "Identifier on the bus; Damiao: to 15.", kRequired},
};
constexpr Setting<DriveConfig> kJoint[] = {
    {"sign", &DriveConfig::sign, -1, 1, "joint = sign x drive / gear + zero_rad.", nullptr,
     "-1, 1"},
    {"gear", &DriveConfig::gear, 0.01, 100.0, "Turns of the drive's output for one of the joint."},
    {"zero_rad", &DriveConfig::zero_rad, -10.0, 10.0,
     "The joint's position where the drive's is zero; check --zero writes it."},
    {"reported_torque", &DriveConfig::reported_torque, 0.5, 2.0,
     "Torque that the drive reports over the one that it gives; check --nudge measures it."},
};

using I = ImuConfig;
constexpr Setting<I> kImu[] = {
    {"protocol", words<&I::protocol>(kImuProtocols), "MicroStrain's MIP, or Xsens' MTData2."},
    {"device", &I::device, "Serial line; better its name in /dev/serial/by-id.", kRequired},
    {"baud", &I::baud, 9600, 4e6, "Speed of the serial line."},
};
constexpr Setting<I> kImuRate[] = {
    {"rate_hz", &I::rate_hz, 100, 1000, "Samples of acceleration and angular rate.",
     "500; xsens: 400"},
};
constexpr Setting<I> kQuaternionRate[] = {
    {"quaternion_rate_hz", &I::quaternion_rate_hz, 100, 1000,
     "Samples of attitude: rate_hz over a whole number.", "rate_hz, at most 500"},
};
struct Mounting {
  Vector3 rpy_deg{};
};
constexpr Setting<Mounting> kMounting[] = {
    {"mounting_rpy_deg", &Mounting::rpy_deg, -360.0, 360.0,
     "Roll, pitch, yaw from a sensor that lies flat, x to the front, to how it sits."},
};

constexpr Setting<StopLineConfig> kStopChip[] = {
    {"chip", &StopLineConfig::chip,
     "GPIO chip of the emergency stop's switch (/dev/gpiochip0); empty: no such switch."},
};
constexpr Setting<StopLineConfig> kStopLine[] = {
    {"line", &StopLineConfig::line, 0, 1023, "Line of that chip; high: not pressed.",
     "required with a chip"},
};

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
  BusKeys keys;
  read_settings(t, "", kInterface, keys);
  bus.interface = keys.interface;
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
  keys.fd = !formats.classic;
  read_settings(t, "", kFd, keys);
  if (!(keys.fd ? formats.fd : formats.classic)) {
    throw InputError(fmt::format(
        "hardware.bus[{}] ({}): {} drives speak {} alone, found fd = {}", before.size(),
        bus.interface, std::visit([](const auto& drive) { return drive.kProtocol; }, bus.any_drive),
        formats.fd ? "CAN FD" : "classic CAN", keys.fd));
  }
  bus.format = keys.fd ? CanFormat::kFdWithBitRateSwitch : CanFormat::kClassic;
  read_settings(t, "", kNominalRate, bus.rates);
  if (keys.fd) read_settings(t, "", kDataRate, bus.rates);
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

DriveConfig read_joint_drive(ConfigTree& t, const DriveKeys& keys, const HardwareConfig& hardware) {
  const std::string where = fmt::format("hardware.drive of {}", keys.joint);
  DriveConfig drive;
  drive.bus = bus_index(hardware.buses, keys.bus, keys.joint);
  const BusConfig& bus = hardware.buses[drive.bus];
  if (keys.id == 0) throw InputError(where + ": found no id, expected 1 to 126");
  drive.drive = bus.any_drive;
  std::visit(
      [&](auto& d) {
        set_address(d, keys.id, bus.format);
        read_drive(d, t, where);
      },
      drive.drive);
  drive.max_torque_nm = drive.ranges().torque_nm;
  read_settings(t, "", kJoint, drive);
  if (drive.sign == 0) throw InputError(where + ": sign 0, expected 1 or -1");
  return drive;
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
  check("speed", gate.speed_limit_radps[j], d.reply_speed_radps(), "rad/s");
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
    DriveKeys keys;
    read_settings(t, "", kDrive, keys);
    const std::string& joint = keys.joint;
    const auto found = std::find(robot.joint_names.begin(), robot.joint_names.end(), joint);
    if (found == robot.joint_names.end()) {
      throw InputError(fmt::format("hardware.drive: joint '{}', expected one of {}", joint,
                                   fmt::join(robot.joint_names, ", ")));
    }
    const auto j = static_cast<int>(found - robot.joint_names.begin());
    if (seen[j]) throw InputError(fmt::format("hardware.drive: joint {} stands twice", joint));
    seen[j] = true;
    h.drives[j] = read_joint_drive(t, keys, h);
    require_range(h.drives[j], j, joint, h.torque_scale, gate);
  }
  for (int j = 0; j < kNumJoints; ++j) {
    if (seen[j]) continue;
    throw InputError(fmt::format("hardware.drive: found none of joint {}", robot.joint_names[j]));
  }
  require_one_id_each(h, robot);
}

ImuConfig read_imu(ConfigTree& config) {
  const char* const table = "hardware.imu";
  ImuConfig imu;
  read_settings(config, table, kImu, imu);
  if (imu.device.empty()) {
    throw InputError("hardware.imu.device: found none, expected a serial line (/dev/ttyS0)");
  }
  imu.rate_hz = imu.protocol == ImuProtocol::kMip ? 500 : 400;
  read_settings(config, table, kImuRate, imu);
  imu.quaternion_rate_hz = std::min(imu.rate_hz, 500);
  read_settings(config, table, kQuaternionRate, imu);
  Mounting mounting;
  read_settings(config, table, kMounting, mounting);
  Vector3 rpy_rad;
  for (int i = 0; i < 3; ++i) rpy_rad[i] = mounting.rpy_deg[i] * std::numbers::pi / 180.0;
  imu.mounting = ImuMounting::from_rpy(rpy_rad);
  check(imu);
  return imu;
}

StopLineConfig read_emergency_stop(ConfigTree& config) {
  const char* const table = "hardware.emergency_stop";
  StopLineConfig stop;
  read_settings(config, table, kStopChip, stop);
  if (stop.chip.empty()) return stop;
  if (!config.has("hardware.emergency_stop.line")) {
    throw InputError(
        fmt::format("hardware.emergency_stop.line: found none, expected the number of a line of {}",
                    stop.chip));
  }
  read_settings(config, table, kStopLine, stop);
  return stop;
}

}  // namespace

HardwareConfig read_hardware_config(ConfigTree& config, const RobotDescription& robot,
                                    const GateConfig& gate) {
  HardwareConfig h;
  read_settings(config, "hardware", kExchange, h);
  if (kControlHz % h.rate_hz != 0) {
    throw InputError(
        fmt::format("hardware.rate_hz: {}, expected a divisor of {} (4000, 2000, "
                    "1000, 800, 500, ...)",
                    h.rate_hz, kControlHz));
  }
  read_settings(config, "hardware", std::array{drive_timeout(h.mode)}, h);
  read_settings(config, "hardware", kGuards, h);
  if (h.voltage_low_v > h.voltage_high_v) {
    throw InputError(fmt::format("hardware.voltage_low_v: {} is above hardware.voltage_high_v, {}",
                                 h.voltage_low_v, h.voltage_high_v));
  }
  read_settings(config, "hardware", kFirstWalks, h);
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

std::vector<SettingLine> hardware_settings() {
  std::vector<SettingLine> lines;
  const std::string hardware = "hardware", bus = "hardware.bus[]", drive = "hardware.drive[]";
  list_settings(lines, hardware, kExchange, std::array{drive_timeout(DriveMode::kGains)}, kGuards,
                kFirstWalks);
  list_settings(lines, bus, kInterface, kProtocol);
  const std::map<std::string, AnyDrive> known = families(AnyDrive{});
  for (const auto& [name, family] : known) {
    lines.back().range += (lines.back().range.empty() ? "" : ", ") + name;
  }
  list_settings(lines, bus, kFd, kNominalRate, kDataRate);
  list_settings(lines, drive, kDrive, kJoint);
  for (const auto& [name, family] : known) {
    std::visit([&](const auto& d) { list_drive_settings(d, lines, drive); }, family);
  }
  list_settings(lines, hardware + ".imu", kImu, kImuRate, kQuaternionRate, kMounting);
  list_settings(lines, hardware + ".emergency_stop", kStopChip, kStopLine);
  return lines;
}

std::string drive_name(const HardwareConfig& hardware, const RobotDescription& robot, int joint) {
  const DriveConfig& drive = hardware.drives[joint];
  return fmt::format("{} ({} id {})", robot.joint_names[joint], hardware.buses[drive.bus].interface,
                     drive.id());
}

}  // namespace sandrunner
