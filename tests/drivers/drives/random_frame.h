// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <random>

#include "drivers/can/can_frame.h"

namespace sandrunner {

/// Any bytes, often with an id and a length that a decoder takes; sometimes a length that no frame
/// has.
inline CanFrame random_frame(std::mt19937& random, std::uint32_t likely_id, int likely_length) {
  CanFrame frame;
  frame.id = random() % 4 != 0 ? likely_id : random() & kMaxExtendedId;
  frame.extended = random() % 8 == 0;
  frame.fd = random() % 2 == 0;
  frame.error = random() % 16 == 0;
  frame.length = static_cast<std::uint8_t>(random() % 2 == 0 ? likely_length : random() % 256);
  // Half of them near the values that mean something.
  const bool is_structured = random() % 2 == 0;
  for (std::uint8_t& byte : frame.data) {
    byte = static_cast<std::uint8_t>(is_structured ? random() % 0x34 : random());
  }
  return frame;
}

}  // namespace sandrunner
