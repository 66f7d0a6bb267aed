// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

namespace sandrunner {

inline constexpr int kMaxClassicBytes = 8;
inline constexpr int kMaxFdBytes = 64;
inline constexpr std::uint32_t kMaxStandardId = 0x7FF;
inline constexpr std::uint32_t kMaxExtendedId = 0x1FFFFFFF;

/// One CAN or CAN FD frame. Bytes from `length` on mean nothing.
struct CanFrame {
  std::uint32_t id = 0;   ///< 11 bits, or 29 if `extended`; the error class if `error`
  bool extended = false;  ///< 29-bit identifier
  bool fd = false;        ///< CAN FD: up to 64 bytes, in the lengths of can_fd_length()
  bool brs = false;       ///< CAN FD: data at the bus's data rate
  bool error = false;     ///< no frame of a node but a report of the controller: see can_error.h
  std::uint8_t length = 0;
  std::array<std::uint8_t, kMaxFdBytes> data{};
};
static_assert(std::is_trivially_copyable_v<CanFrame>);

/// The shortest length that CAN FD can carry (0 to 8, 12, 16, 20, 24, 32, 48, 64) for `bytes` of
/// data, 0 to 64; 64 for more.
constexpr int can_fd_length(int bytes) noexcept {
  for (const int length : {8, 12, 16, 20, 24, 32, 48}) {
    if (bytes <= length) return length == 8 ? bytes : length;
  }
  return kMaxFdBytes;
}

/// Whether a controller can send this: identifier and length are possible for its kind.
constexpr bool is_sendable(const CanFrame& frame) noexcept {
  if (frame.error || frame.id > (frame.extended ? kMaxExtendedId : kMaxStandardId)) return false;
  if (!frame.fd) return !frame.brs && frame.length <= kMaxClassicBytes;
  return frame.length <= kMaxFdBytes && can_fd_length(frame.length) == frame.length;
}

/// The format in which a drive wants its frames.
enum class CanFormat : std::uint8_t { kClassic, kFdWithBitRateSwitch };

}  // namespace sandrunner
