// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/check/bus_scan.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <thread>

namespace sandrunner {
namespace {

constexpr std::chrono::milliseconds kAnswer{5};

/// All that has arrived.
template <typename Use>
void for_each_frame(CanSocket& socket, const Use& use) {
  std::array<ReceivedFrame, CanSocket::kMaxFrames> received;
  // A bus that never falls silent is no reason to stay for ever.
  for (int round = 0; round < 100; ++round) {
    const CanResult result = socket.receive(received);
    for (int i = 0; i < result.frames; ++i) use(received[i].frame);
    if (result.frames < CanSocket::kMaxFrames) return;
  }
}

bool has_damiao(const HardwareConfig& config, int bus) {
  return std::any_of(config.drives.begin(), config.drives.end(), [&](const DriveConfig& drive) {
    return drive.bus == bus && drive.protocol == Protocol::kMit &&
           drive.mit.variant == MitVariant::kDamiao;
  });
}

}  // namespace

CanFrame scan_frame(const BusConfig& bus, int id) {
  CanFrame frame;
  if (bus.protocol == Protocol::kMit) {
    MitDrive drive;
    drive.motor_id = static_cast<std::uint16_t>(id);
    drive.format = bus.format;
    drive.limits.velocity_radps = drive.limits.torque_nm = drive.limits.reply_torque_nm = 1.0;
    encode_mit_special(drive, MitSpecial::kDisable, frame);
  } else {
    MoteusDrive drive;
    drive.id = static_cast<std::uint8_t>(id);
    encode_moteus_query(drive, kMoteusState, frame);
  }
  return frame;
}

bool is_scan_reply(const BusConfig& bus, bool damiao, int id, const CanFrame& frame) {
  if (frame.error) return false;
  if (bus.protocol == Protocol::kMoteus) {
    return frame.fd && moteus_address(frame).source == id;
  }
  if (frame.extended || frame.length < 6 || frame.length > kMaxClassicBytes) return false;
  return frame.data[0] == id || (damiao && (frame.data[0] & 0xF) == id);
}

std::vector<std::vector<ScannedDrive>> scan(const HardwareConfig& config,
                                            const CanSockets& sockets) {
  std::vector<std::vector<ScannedDrive>> answered(sockets.size());
  for (int id = 1; id <= kMostScannedId; ++id) {
    for (std::size_t b = 0; b < sockets.size(); ++b) {
      if (!sockets[b]) continue;
      const CanFrame frame = scan_frame(config.buses[b], id);
      sockets[b]->send({&frame, 1});
    }
    std::this_thread::sleep_for(kAnswer);
    for (std::size_t b = 0; b < sockets.size(); ++b) {
      if (!sockets[b]) continue;
      const bool damiao = has_damiao(config, static_cast<int>(b));
      for_each_frame(*sockets[b], [&](const CanFrame& frame) {
        std::vector<ScannedDrive>& drives = answered[b];
        const bool known = !drives.empty() && drives.back().id == id;
        if (known || !is_scan_reply(config.buses[b], damiao, id, frame)) return;
        drives.push_back({.id = id, .reply_id = frame.id});
      });
    }
  }
  return answered;
}

}  // namespace sandrunner
