// SPDX-License-Identifier: BSD-3-Clause
// The ids that answer on the buses, whatever the configuration lists.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "drivers/robot/drive_look.h"
#include "drivers/robot/hardware_config.h"

namespace sandrunner {

/// A drive that answered a probe (encode_probe): a query of its state, or an off frame.
struct ScannedDrive {
  int id = 0;
  std::uint32_t reply_id = 0;  ///< identifier of its reply
};

inline constexpr int kMostScannedId = 32;

/// Probes the ids 1 to kMostScannedId of every bus, 0.2 s in all; returns the answers by bus.
std::vector<std::vector<ScannedDrive>> scan(const HardwareConfig& config,
                                            const CanSockets& sockets);

/// The probe of scan() for `id`.
CanFrame scan_frame(const BusConfig& bus, int id);
/// Whether the frame is an answer of drive `id` on bus `bus` of the configuration.
bool is_scan_reply(const HardwareConfig& config, int bus, int id, const CanFrame& frame);

}  // namespace sandrunner
