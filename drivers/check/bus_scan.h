// SPDX-License-Identifier: BSD-3-Clause
// Who is on the buses, whatever the configuration says.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "drivers/robot/drive_look.h"
#include "drivers/robot/hardware_config.h"

namespace sandrunner {

/// A drive that answered when it was asked for its state, or told to be off (encode_probe).
struct ScannedDrive {
  int id = 0;
  std::uint32_t reply_id = 0;  ///< identifier of its reply
};

inline constexpr int kMostScannedId = 32;

/// Speaks to the ids 1 to kMostScannedId of every bus, 0.2 s in all; returns who answered, by bus.
std::vector<std::vector<ScannedDrive>> scan(const HardwareConfig& config,
                                            const CanSockets& sockets);

/// The frame with which scan() speaks to `id`.
CanFrame scan_frame(const BusConfig& bus, int id);
/// Whether it is what a drive `id` answers on bus `bus` of the configuration.
bool is_scan_reply(const HardwareConfig& config, int bus, int id, const CanFrame& frame);

}  // namespace sandrunner
