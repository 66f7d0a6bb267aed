// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "drivers/robot/hardware_config.h"

namespace sandrunner {

/// The load of one bus.
struct PlannedBus {
  std::string interface;
  int drives = 0;
  BusLoad load;
  int most_drives = 0;      ///< that fit at this rate
  double most_rate_hz = 0;  ///< at which these drives fit, a divisor of the control rate; 0: none
  bool overloaded() const noexcept { return load.worst > kMaxBusLoad; }
};

/// Load of every bus, from the frames of an exchange with each drive.
std::vector<PlannedBus> plan_buses(const HardwareConfig& hardware);

/// The plan as a table of text.
std::string plan_table(const HardwareConfig& hardware, const std::vector<PlannedBus>& plan);

/// Whether the kernel emulates this interface (vcan): it has no bit rate. A missing one is not
/// emulated.
bool is_virtual(const std::string& interface);

/// The problem of a planned bus on a real adapter, in one line with what would fit; empty if there
/// is none.
std::string overload(const HardwareConfig& hardware, const PlannedBus& bus);

/// Throws InputError for the first bus that is overloaded and for which `is_free` is false.
void require_capacity(const HardwareConfig& hardware,
                      bool (*is_free)(const std::string& interface) = is_virtual);

}  // namespace sandrunner
