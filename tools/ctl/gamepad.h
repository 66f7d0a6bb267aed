// SPDX-License-Identifier: BSD-3-Clause
// From a gamepad's events to velocities: no device, no clock.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "rt/core/messages.h"

namespace sandrunner::ctl {

/// Range of an axis as its device states it.
struct AxisRange {
  int min = -32768, max = 32767;
  int flat = 0;  ///< half width of the rest position
};

/// State of a gamepad, from its evdev events (linux/input-event-codes.h): the left stick (ABS_X,
/// ABS_Y) gives vy and vx, the right stick (ABS_RX) the yaw rate; the left shoulder button (BTN_TL)
/// enables them.
class Gamepad {
 public:
  /// Axes X, Y and RX, by their evdev codes.
  static constexpr std::array<std::uint16_t, 3> kAxes = {0x00, 0x01, 0x03};

  explicit Gamepad(const std::array<AxisRange, 3>& ranges) : ranges_(ranges) { center(); }

  void event(std::uint16_t type, std::uint16_t code, std::int32_t value);
  /// From now on the enable button has no effect until it is pressed again.
  void stop() noexcept { enabled_ = false; }
  /// Full deflection commands `scale` times kFullSpeed. Nothing: the enable button is not held.
  std::optional<VelocityCommand> command(double scale) const;

 private:
  void center();
  double deflection(std::size_t axis) const;  // -1 to 1, zero around the rest position

  std::array<AxisRange, 3> ranges_;
  std::array<int, 3> values_{};
  bool enabled_ = false;
};

}  // namespace sandrunner::ctl
