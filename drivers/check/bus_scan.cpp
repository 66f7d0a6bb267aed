// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/check/bus_scan.h"

#include <algorithm>
#include <chrono>
#include <thread>

namespace sandrunner {
namespace {

constexpr std::chrono::milliseconds kAnswer{5};

/// A drive as `like` with another id.
AnyDrive with_id(const AnyDrive& like, int id, CanFormat format) {
  AnyDrive drive = like;
  std::visit([&](auto& d) { set_address(d, id, format); }, drive);
  return drive;
}

}  // namespace

CanFrame scan_frame(const BusConfig& bus, int id) {
  CanFrame frame;
  std::visit([&](const auto& drive) { encode_probe(drive, frame); },
             with_id(bus.any_drive, id, bus.format));
  return frame;
}

bool is_scan_reply(const HardwareConfig& config, int bus, int id, const CanFrame& frame) {
  const BusConfig& b = config.buses[bus];
  const auto answers = [&](const AnyDrive& like) {
    return std::visit([&](const auto& drive) { return is_probe_reply(drive, frame); },
                      with_id(like, id, b.format));
  };
  // Replies may differ within a family: those of the bus's own drives are known as well.
  return answers(b.any_drive) ||
         std::any_of(config.drives.begin(), config.drives.end(), [&](const DriveConfig& drive) {
           return drive.bus == bus && answers(drive.drive);
         });
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
      for_each_frame(*sockets[b], 100, [&](const ReceivedFrame& reply) {
        std::vector<ScannedDrive>& drives = answered[b];
        const bool known = !drives.empty() && drives.back().id == id;
        if (known || !is_scan_reply(config, static_cast<int>(b), id, reply.frame)) return;
        drives.push_back({.id = id, .reply_id = reply.frame.id});
      });
    }
  }
  return answered;
}

}  // namespace sandrunner
