// SPDX-License-Identifier: BSD-3-Clause
// How long frames take on the wire, and how many motors a bus carries.
//
// Bits of a frame include the three of the pause after it. The worst case is that of bit stuffing:
// one bit after the first five equal ones and one after every four from then on. Sources: ISO
// 11898-1:2015 for both formats; Davis et al., "Controller Area Network (CAN) schedulability
// analysis", Real-Time Systems 35 (2007), for the worst case of classic frames.
//
// Not counted: what a drive takes to answer, what the host takes, repeated frames, error frames.
#pragma once

#include <span>

namespace sandrunner {

/// What decides how long a frame is.
struct FrameShape {
  int bytes = 8;  ///< of data; classic 0 to 8, CAN FD a length of can_fd_length()
  bool extended = false;
  bool fd = false;
  bool brs = false;  ///< CAN FD: data at `BusRates::data_hz`
};

/// Bits of a second on the wire. `data_hz` counts for frames with `brs` alone.
struct BusRates {
  double nominal_hz = 1e6;
  double data_hz = 5e6;
};

struct BitCount {
  int nominal = 0;  ///< without stuff bits that depend on the data
  int worst = 0;
};

/// The bits of a frame at either rate; all are at the nominal rate without `brs`.
struct FrameBits {
  BitCount slow;
  BitCount fast;
};
FrameBits frame_bits(const FrameShape& shape) noexcept;

/// Seconds that one or more frames take on the wire.
struct WireTime {
  double nominal_s = 0.0;
  double worst_s = 0.0;
};
WireTime wire_time(const FrameShape& shape, const BusRates& rates) noexcept;

WireTime wire_time(std::span<const FrameShape> frames, const BusRates& rates) noexcept;

/// Share of the time for which a bus is busy, if these frames go over it in each cycle.
struct BusLoad {
  double nominal = 0.0;
  double worst = 0.0;
};
BusLoad bus_load(std::span<const FrameShape> frames, double cycle_hz,
                 const BusRates& rates) noexcept;

/// Above this worst case no repeated frame fits and replies come late.
inline constexpr double kMaxBusLoad = 0.8;

/// The most motors whose worst case does not exceed kMaxBusLoad. `each_motor`: its command and its
/// reply.
int motors_that_fit(std::span<const FrameShape> each_motor, double cycle_hz,
                    const BusRates& rates) noexcept;

}  // namespace sandrunner
