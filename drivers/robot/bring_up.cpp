// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/robot/bring_up.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <thread>

#include "drivers/can/damiao_registers.h"
#include "drivers/robot/bus_plan.h"
#include "drivers/robot/drive.h"
#include "rt/base/errors.h"

namespace sandrunner {
namespace {

using Clock = std::chrono::system_clock;  // that of the kernel's stamps
constexpr std::chrono::milliseconds kExchange{5};

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch())
      .count();
}

std::string name_of(const HardwareConfig& config, const RobotDescription& robot, int j) {
  const DriveConfig& drive = config.drives[j];
  return fmt::format("{} ({} id {})", robot.joint_names[j], config.buses[drive.bus].interface,
                     drive.id());
}

/// What a Damiao's register holds after it was written, if `value` is given. Nothing if it does not
/// answer.
std::optional<double> damiao_register(const MitDrive& drive, CanSocket& socket, DamiaoRegister reg,
                                      std::optional<double> value) {
  for (int attempt = 0; attempt < 5; ++attempt) {
    const DamiaoAccess access{.operation = value ? DamiaoOperation::kWrite : DamiaoOperation::kRead,
                              .reg = reg,
                              .value = value.value_or(0.0)};
    CanFrame frame;
    if (encode_damiao_request(drive, access, frame) != DamiaoStatus::kOk) return std::nullopt;
    if (socket.send({&frame, 1}).status != CanStatus::kOk) continue;
    for (int wait = 0; wait < 10; ++wait) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      std::array<ReceivedFrame, CanSocket::kMaxFrames> received;
      const CanResult result = socket.receive(received);
      for (int i = 0; i < result.frames; ++i) {
        DamiaoAccess reply;
        if (decode_damiao_reply(drive, received[i].frame, reply) == DamiaoStatus::kOk &&
            reply.reg == reg) {
          return reply.value;
        }
      }
    }
  }
  return std::nullopt;
}

/// The protection against a drive whose numbers mean something else: what it can tell, it is asked.
void require_damiao(const HardwareConfig& config, const std::string& name, const MitDrive& drive,
                    CanSocket& socket) {
  const auto require = [&](DamiaoRegister reg, const char* what, double configured,
                           std::optional<double> value) {
    const std::optional<double> told = damiao_register(drive, socket, reg, value);
    if (!told) {
      throw InputError(
          fmt::format("{}: does not tell its {} (register {})", name, what, static_cast<int>(reg)));
    }
    if (std::fabs(*told - configured) > 1e-3 * configured) {
      throw InputError(
          fmt::format("{}: its {} is {:.6g}, configured is {:.6g}", name, what, *told, configured));
    }
  };
  require(DamiaoRegister::kPositionMax, "position range (PMAX)", drive.limits.position_rad, {});
  require(DamiaoRegister::kVelocityMax, "velocity range (VMAX)", drive.limits.velocity_radps, {});
  require(DamiaoRegister::kTorqueMax, "torque range (TMAX)", drive.limits.torque_nm, {});
  const double timeout = std::round(config.drive_timeout_s / kDamiaoTimeoutUnit_s);
  require(DamiaoRegister::kTimeout, "time-out (units of 50 us)", timeout, timeout);
  // The answer to a write may be an echo.
  require(DamiaoRegister::kTimeout, "time-out (units of 50 us)", timeout, {});
}

}  // namespace

CanSockets open_buses(const HardwareConfig& config) {
  require_capacity(config);
  CanSockets sockets;
  for (std::size_t b = 0; b < config.buses.size(); ++b) {
    const BusConfig& bus = config.buses[b];
    std::vector<CanFilter> filters;
    for (const DriveConfig& drive : config.drives) {
      if (drive.bus != static_cast<int>(b)) continue;
      if (drive.protocol == Protocol::kMit) {
        filters.push_back({.id = drive.mit.reply_id});
      } else {
        // Its replies are standard or extended, by its number.
        filters.push_back({.id = 0, .mask = 0});
        filters.push_back({.id = 0, .mask = 0, .extended = true});
      }
    }
    sockets.push_back(std::make_unique<CanSocket>(CanSocketConfig{
        .interface = bus.interface, .fd = bus.format != CanFormat::kClassic, .filters = filters}));
  }
  return sockets;
}

JointArray<FoundDrive> look_for_drives(const HardwareConfig& config, const CanSockets& sockets) {
  JointArray<FoundDrive> found;
  JointArray<Drive> drives;
  for (int j = 0; j < kNumJoints; ++j) drives[j] = Drive(config.drives[j], config);
  for (int exchange = 0; exchange < kLookExchanges; ++exchange) {
    const std::int64_t sent_ns = now_ns();
    for (int j = 0; j < kNumJoints; ++j) {
      CanFrame frame;
      drives[j].off_frame(frame);
      sockets[config.drives[j].bus]->send({&frame, 1});
    }
    std::this_thread::sleep_for(kExchange);
    for (std::size_t b = 0; b < sockets.size(); ++b) {
      std::array<ReceivedFrame, CanSocket::kMaxFrames> received;
      const CanResult result = sockets[b]->receive(received);
      for (int i = 0; i < result.frames; ++i) {
        for (int j = 0; j < kNumJoints; ++j) {
          if (config.drives[j].bus != static_cast<int>(b)) continue;
          if (!drives[j].take(received[i].frame, 0)) continue;
          FoundDrive& f = found[j];
          ++f.replies;
          const double trip_s = 1e-9 * static_cast<double>(received[i].stamp_ns - sent_ns);
          f.round_trip_s = std::max(f.round_trip_s, trip_s);
          break;
        }
      }
    }
  }
  for (int j = 0; j < kNumJoints; ++j) {
    found[j].position_rad = drives[j].position_rad();
    found[j].fault = drives[j].fault();
    found[j].temperature_degc = drives[j].temperature_degc();
    found[j].voltage_v = drives[j].voltage_v();
  }
  return found;
}

void require_drives(const HardwareConfig& config, const RobotDescription& robot,
                    const GateConfig& gate, const CanSockets& sockets) {
  const JointArray<FoundDrive> found = look_for_drives(config, sockets);
  for (int j = 0; j < kNumJoints; ++j) {
    const std::string name = name_of(config, robot, j);
    // The first answer may come after the exchange; one in twenty lost is a bad bus.
    if (found[j].replies < kLookExchanges - kLookExchanges / 20) {
      throw InputError(
          fmt::format("{}: {} of {} requests answered; its power, its id, its bus, and "
                      "who else has that id",
                      name, found[j].replies, kLookExchanges));
    }
    if (found[j].replies > kLookExchanges) {
      throw InputError(fmt::format("{}: {} answers to {} requests: two drives have that id", name,
                                   found[j].replies, kLookExchanges));
    }
    const double q = found[j].position_rad;
    if (q < gate.joint_lower_rad[j] - gate.joint_fault_rad ||
        q > gate.joint_upper_rad[j] + gate.joint_fault_rad) {
      throw InputError(
          fmt::format("{}: is at {:.3f} rad, where the joint (from {:.3f} to {:.3f}) "
                      "cannot be: its zero, sign or gear, or another drive",
                      name, q, gate.joint_lower_rad[j], gate.joint_upper_rad[j]));
    }
    if (found[j].fault != 0) {
      throw InputError(fmt::format("{}: reports a fault: {}", name,
                                   drive_fault_words(config.drives[j], found[j].fault)));
    }
    const DriveConfig& drive = config.drives[j];
    if (drive.protocol == Protocol::kMoteus) continue;  // told with each command
    if (drive.mit.variant == MitVariant::kDamiao) {
      require_damiao(config, name, drive.mit, *sockets[drive.bus]);
    } else if (!config.timeout_unverified) {
      throw InputError(
          fmt::format("{}: cannot tell its time-out over CAN; set it in the drive, then set "
                      "hardware.timeout_unverified=true",
                      name));
    }
  }
}

}  // namespace sandrunner
