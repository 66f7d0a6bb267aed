// SPDX-License-Identifier: BSD-3-Clause
// What happens to a CAN interface besides frames.
#pragma once

#include <string>

namespace sandrunner::hil {

/// `ip link set INTERFACE up|down`. False: no right to.
bool set_link(const std::string& interface, bool up) noexcept;

/// What a controller says of its bus, linux/can/error.h: it left it, it is back.
enum class BusEvent { kOff, kRestarted };

/// Puts the controller's error frame before everybody who listens, as the interface itself would.
/// False: the interface took none.
bool inject(const std::string& interface, BusEvent event) noexcept;

}  // namespace sandrunner::hil
