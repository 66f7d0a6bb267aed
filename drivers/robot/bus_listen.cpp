// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/robot/bus_listen.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <chrono>
#include <numeric>
#include <thread>

#include "rt/base/errors.h"

namespace sandrunner {

std::unique_ptr<CanSocket> open_bus(const BusConfig& bus) {
  constexpr std::array<CanFilter, 2> kAll = {
      CanFilter{.id = 0, .mask = 0, .extended = false},
      CanFilter{.id = 0, .mask = 0, .extended = true},
  };
  return std::make_unique<CanSocket>(CanSocketConfig{
      .interface = bus.interface, .fd = bus.format != CanFormat::kClassic, .filters = kAll});
}

void BusTraffic::add(const HardwareConfig& config, int bus, const CanFrame& frame) noexcept {
  if (frame.error) return;
  ++frames;
  for (int j = 0; j < kNumJoints; ++j) {
    if (config.drives[j].bus != bus) continue;
    Drive drive(config.drives[j], config);
    commands[j] += drive.is_command(frame) ? 1 : 0;
    replies[j] += drive.take(frame, 0) ? 1 : 0;
  }
}

std::vector<BusTraffic> listen(const HardwareConfig& config, const CanSockets& sockets) {
  std::this_thread::sleep_for(std::chrono::milliseconds(kListen_ms));
  std::vector<BusTraffic> traffic(sockets.size());
  for (std::size_t b = 0; b < sockets.size(); ++b) {
    if (!sockets[b]) continue;
    for_each_frame(*sockets[b], 100, [&](const ReceivedFrame& received) {
      traffic[b].add(config, static_cast<int>(b), received.frame);
    });
  }
  return traffic;
}

std::vector<std::string> traffic_problems(const HardwareConfig& config,
                                          const RobotDescription& robot,
                                          const std::vector<BusTraffic>& traffic) {
  std::vector<std::string> problems;
  for (std::size_t b = 0; b < traffic.size(); ++b) {
    const BusTraffic& bus = traffic[b];
    if (bus.frames == 0) continue;
    std::vector<std::string> joints;
    for (int j = 0; j < kNumJoints; ++j) {
      if (bus.commands[j] + bus.replies[j] > 0) joints.push_back(robot.joint_names[j]);
    }
    const int commands = std::accumulate(bus.commands.begin(), bus.commands.end(), 0);
    const int replies = std::accumulate(bus.replies.begin(), bus.replies.end(), 0);
    const std::string of_drives = joints.empty()
                                      ? "none of them of a configured drive"
                                      : fmt::format("{} commands to and {} replies of {}", commands,
                                                    replies, fmt::join(joints, ", "));
    problems.push_back(
        fmt::format("hardware.bus {}: found {} frames in {} s ({}), expected a silent bus: another "
                    "program uses it; stop that first. Nothing was sent",
                    config.buses[b].interface, bus.frames, 1e-3 * kListen_ms, of_drives));
  }
  return problems;
}

CanSockets open_silent_buses(const HardwareConfig& config, const RobotDescription& robot) {
  CanSockets sockets;
  for (const BusConfig& bus : config.buses) sockets.push_back(open_bus(bus));
  const std::vector<std::string> problems =
      traffic_problems(config, robot, listen(config, sockets));
  if (!problems.empty()) throw InputError(problems.front());
  return sockets;
}

}  // namespace sandrunner
