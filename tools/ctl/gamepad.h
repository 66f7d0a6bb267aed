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

/// State of a gamepad, from its evdev events (linux/input-event-codes.h): left stick ABS_X, ABS_Y
/// for vy and vx, right stick ABS_RX for the yaw rate, left shoulder button BTN_TL as enable
/// button.
class Gamepad {
 public:
  /// Axes X, Y and RX, by their evdev codes.
  static constexpr std::array<std::uint16_t, 3> kAxes = {0x00, 0x01, 0x03};

  explicit Gamepad(const std::array<AxisRange, 3>& ranges) : ranges_(ranges) { center(); }

  void event(std::uint16_t type, std::uint16_t code, std::int32_t value);
  /// From now on the enable button counts only after it was pressed anew.
  void stop() noexcept { enabled_ = false; }
  /// `scale`: full deflection commands this times kFullSpeed. Nothing: the enable button is not
  /// held.
  std::optional<VelocityCommand> command(double scale) const;

 private:
  void center();
  double deflection(std::size_t axis) const;  // -1 to 1, zero around the rest position

  std::array<AxisRange, 3> ranges_;
  std::array<int, 3> values_{};
  bool enabled_ = false;
};

}  // namespace sandrunner::ctl
