// SPDX-License-Identifier: BSD-3-Clause
// What happens to a CAN interface besides frames.
#pragma once

#include <string>

namespace sandrunner::hil {

/// `ip link set INTERFACE up|down`. False: no right to.
bool set_link(const std::string& interface, bool up) noexcept;

/// Gives the interface a send queue for this many frames: with 0, senders get ENOBUFS, as from the
/// full queue of a bus on which no node acknowledges. The first time holds up the whole interface
/// for some 10 ms, a change does not. False: no right to.
bool set_queue(const std::string& interface, unsigned frames) noexcept;
/// Takes it away again.
bool remove_queue(const std::string& interface) noexcept;

/// What a controller says of its bus, linux/can/error.h: it left it, it is back.
enum class BusEvent { kOff, kRestarted };

/// Puts the controller's error frame before everybody who listens, as the interface itself would.
/// False: the interface took none.
bool inject(const std::string& interface, BusEvent event) noexcept;

}  // namespace sandrunner::hil
