// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/can/bus_load.h"

#include <algorithm>
#include <cmath>

namespace sandrunner {
namespace {

// The most stuff bits in `bits` bits that may be stuffed.
constexpr int stuff_bits(int bits) noexcept { return (bits - 1) / 4; }

FrameBits classic_bits(const FrameShape& shape) noexcept {
  // Start of frame to CRC is stuffed; delimiters, acknowledgement, end and pause (13) are not.
  const int stuffed = (shape.extended ? 54 : 34) + 8 * shape.bytes;
  const int bits = stuffed + 13;
  return {{bits, bits + stuff_bits(stuffed)}, {0, 0}};
}

FrameBits fd_bits(const FrameShape& shape) noexcept {
  // Start of frame to bit rate switch; then ESI, length and data at the fast rate, stuffed through.
  const int arbitration = shape.extended ? 36 : 17;
  const int stuffed = arbitration + 5 + 8 * shape.bytes;
  const int slow_stuff = stuff_bits(arbitration);
  const int fast_stuff = stuff_bits(stuffed) - slow_stuff;
  // The stuff count (4) and the CRC have stuff bits at fixed places.
  const int check = shape.bytes <= 16 ? 4 + 17 + 6 : 4 + 21 + 7;
  // CRC delimiter, acknowledgement and its delimiter, end (7), pause (3).
  const int slow = arbitration + 13;
  const int fast = 5 + 8 * shape.bytes + check;
  if (!shape.brs) return {{slow + fast, slow + fast + slow_stuff + fast_stuff}, {0, 0}};
  return {{slow, slow + slow_stuff}, {fast, fast + fast_stuff}};
}

}  // namespace

FrameBits frame_bits(const FrameShape& shape) noexcept {
  return shape.fd ? fd_bits(shape) : classic_bits(shape);
}

WireTime wire_time(const FrameShape& shape, const BusRates& rates) noexcept {
  const FrameBits bits = frame_bits(shape);
  return {bits.slow.nominal / rates.nominal_hz + bits.fast.nominal / rates.data_hz,
          bits.slow.worst / rates.nominal_hz + bits.fast.worst / rates.data_hz};
}

WireTime wire_time(std::span<const FrameShape> frames, const BusRates& rates) noexcept {
  WireTime sum;
  for (const FrameShape& frame : frames) {
    const WireTime time = wire_time(frame, rates);
    sum.nominal_s += time.nominal_s;
    sum.worst_s += time.worst_s;
  }
  return sum;
}

BusLoad bus_load(std::span<const FrameShape> frames, double cycle_hz,
                 const BusRates& rates) noexcept {
  const WireTime time = wire_time(frames, rates);
  return {time.nominal_s * cycle_hz, time.worst_s * cycle_hz};
}

int motors_that_fit(std::span<const FrameShape> each_motor, double cycle_hz,
                    const BusRates& rates) noexcept {
  const double each_s = wire_time(each_motor, rates).worst_s;
  if (!(each_s > 0.0 && cycle_hz > 0.0)) return 0;
  // A billionth more, so that rounding does not refuse what is exactly at the limit.
  const double motors = std::floor(kMaxBusLoad / cycle_hz / each_s + 1e-9);
  return static_cast<int>(std::clamp(motors, 0.0, 1e6));
}

}  // namespace sandrunner
