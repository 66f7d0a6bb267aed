// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/robot/bus_plan.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>

#include "drivers/robot/drive.h"
#include "rt/base/errors.h"

namespace sandrunner {
namespace {

FrameShape shape_of(const CanFrame& frame) {
  return {.bytes = frame.length, .extended = frame.extended, .fd = frame.fd, .brs = frame.brs};
}

/// The command of one exchange and its reply, measured on frames themselves.
std::array<FrameShape, 2> shapes_of(const DriveConfig& config, const HardwareConfig& hardware) {
  CanFrame command, reply;
  Drive(config, hardware).command_frame({0.1, 0.1, 1.0, 0.1, 0.1}, command);
  std::visit([&](const auto& drive) { encode_example_reply(drive, command, reply); }, config.drive);
  return {shape_of(command), shape_of(reply)};
}

}  // namespace

std::vector<PlannedBus> plan_buses(const HardwareConfig& hardware) {
  std::vector<PlannedBus> plan;
  for (std::size_t b = 0; b < hardware.buses.size(); ++b) {
    const BusConfig& bus = hardware.buses[b];
    std::vector<FrameShape> shapes;
    PlannedBus planned;
    planned.interface = bus.interface;
    for (const DriveConfig& drive : hardware.drives) {
      if (drive.bus != static_cast<int>(b)) continue;
      ++planned.drives;
      for (const FrameShape& shape : shapes_of(drive, hardware)) shapes.push_back(shape);
    }
    planned.load = bus_load(shapes, hardware.rate_hz, bus.rates);
    if (planned.drives > 0) {
      planned.most_drives =
          motors_that_fit(std::span(shapes).first(2), hardware.rate_hz, bus.rates);
    }
    for (int parts = 1; parts <= kControlHz / 100; ++parts) {
      if (kControlHz % parts != 0) continue;
      const double rate_hz = static_cast<double>(kControlHz) / parts;
      if (bus_load(shapes, rate_hz, bus.rates).worst > kMaxBusLoad) continue;
      planned.most_rate_hz = rate_hz;
      break;
    }
    plan.push_back(planned);
  }
  return plan;
}

std::string plan_table(const HardwareConfig& hardware, const std::vector<PlannedBus>& plan) {
  std::string table = fmt::format(
      "{} at {} Hz, drives time out {} s after the last command\n"
      "bus           drives   load  worst   fit at {:<5} these fit at\n",
      hardware.mode == DriveMode::kGains ? "the drives close the loops, exchange"
                                         : "the host closes the loops, exchange",
      hardware.rate_hz, hardware.drive_timeout_s, fmt::format("{} Hz", hardware.rate_hz));
  for (const PlannedBus& bus : plan) {
    table +=
        fmt::format("{:<14}{:>6} {:>5.0f} % {:>4.0f} % {:>8}     {:>10} Hz{}\n", bus.interface,
                    bus.drives, 100.0 * bus.load.nominal, 100.0 * bus.load.worst, bus.most_drives,
                    bus.most_rate_hz, bus.overloaded() ? "   OVERLOADED" : "");
  }
  return table;
}

bool is_virtual(const std::string& interface) {
  const std::filesystem::path net = "/sys/class/net/" + interface;
  std::error_code absent;
  return std::filesystem::exists(net, absent) && !std::filesystem::exists(net / "device", absent);
}

std::string overload(const HardwareConfig& hardware, const PlannedBus& bus) {
  if (!bus.overloaded()) return "";
  return fmt::format(
      "hardware.bus {}: {} drives at {} Hz load it by {:.0f} % in the worst case, at most {:.0f} % "
      "leave room for a lost frame; {} drives fit, or {:g} Hz (sandrunner check --plan)",
      bus.interface, bus.drives, hardware.rate_hz, 100.0 * bus.load.worst, 100.0 * kMaxBusLoad,
      bus.most_drives, bus.most_rate_hz);
}

void require_capacity(const HardwareConfig& hardware,
                      bool (*is_free)(const std::string& interface)) {
  for (const PlannedBus& bus : plan_buses(hardware)) {
    if (bus.overloaded() && !is_free(bus.interface)) throw InputError(overload(hardware, bus));
  }
}

}  // namespace sandrunner
