// SPDX-License-Identifier: BSD-3-Clause
// What the controller says of its bus in an error frame (linux/can/error.h).
#pragma once

#include <cstdint>

#include "drivers/can/can_frame.h"

namespace sandrunner {

/// Several may be said at once.
struct CanError {
  bool bus_off = false;    ///< the controller has left the bus: nothing is sent or heard any more
  bool restarted = false;  ///< it is back after bus-off
  bool error_passive = false;     ///< an error counter is above 127
  bool error_warning = false;     ///< an error counter is above 95
  bool error_active = false;      ///< the counters are low again
  bool receive_overflow = false;  ///< the controller lost received frames
  bool send_overflow = false;
  bool send_timeout = false;
  bool no_acknowledge = false;  ///< nobody else on the bus heard a frame: cable, power, bit rate
  bool lost_arbitration = false;
  bool protocol_violation = false;  ///< bit, form or stuff error
  bool transceiver = false;
  bool bus_error = false;
};

/// Reads an error frame; says nothing (all false) for a frame that is none.
CanError decode_can_error(const CanFrame& frame) noexcept;

/// The gravest thing said, in words for a person; "" if nothing is.
const char* words(const CanError& error) noexcept;

}  // namespace sandrunner
