// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "drivers/can/can_frame.h"

namespace sandrunner {

/// A frame of any content, also one that no controller would deliver: flags, length, id, data.
/// `likely_id` is taken where the flags say so, which is half of them.
inline CanFrame fuzz_frame(const std::uint8_t* bytes, std::size_t size, std::uint32_t likely_id) {
  constexpr std::size_t kHeader = 6;
  std::uint8_t header[kHeader] = {};
  std::memcpy(header, bytes, std::min(size, kHeader));
  CanFrame frame;
  frame.fd = (header[0] & 1) != 0;
  frame.brs = (header[0] & 2) != 0;
  frame.extended = (header[0] & 4) != 0;
  frame.error = (header[0] & 8) != 0;
  frame.length = header[1];
  std::memcpy(&frame.id, header + 2, sizeof frame.id);
  if ((header[0] & 16) != 0) frame.id = likely_id;
  if (size > kHeader) {
    std::memcpy(frame.data.data(), bytes + kHeader, std::min(size - kHeader, frame.data.size()));
  }
  return frame;
}

/// What the fuzzer reports.
inline void require(bool holds) {
  if (!holds) std::abort();
}

}  // namespace sandrunner
