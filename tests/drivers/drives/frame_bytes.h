// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <charconv>
#include <string>
#include <string_view>

#include "drivers/can/can_frame.h"

namespace sandrunner {

/// The data of a frame in hexadecimal digits.
inline std::string hex(const CanFrame& frame) {
  std::string text;
  for (int i = 0; i < frame.length; ++i) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    text += kDigits[frame.data[i] >> 4];
    text += kDigits[frame.data[i] & 0xF];
  }
  return text;
}

/// A frame with these data, classic or, beyond 8 bytes, CAN FD.
inline CanFrame frame_of(std::uint32_t id, std::string_view digits) {
  CanFrame frame;
  frame.id = id;
  frame.length = static_cast<std::uint8_t>(digits.size() / 2);
  frame.fd = frame.brs = frame.length > kMaxClassicBytes;
  for (int i = 0; i < frame.length; ++i) {
    std::from_chars(digits.data() + 2 * i, digits.data() + 2 * i + 2, frame.data[i], 16);
  }
  return frame;
}

}  // namespace sandrunner
