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
///
/// A gamepad that has lost its radio looks like one whose stick is held still: the kernel reports
/// changes only, and the release of the enable button would be one. So a stick away from rest
/// commands only for kSilence_ns after the last event. A thumb's tremble is enough to go on; a
/// stick at its stop, where some gamepads report nothing, has to be moved a little.
class Gamepad {
 public:
  /// Axes X, Y and RX, by their evdev codes.
  static constexpr std::array<std::uint16_t, 3> kAxes = {0x00, 0x01, 0x03};

  static constexpr std::int64_t kSilence_ns = 1'000'000'000;

  explicit Gamepad(const std::array<AxisRange, 3>& ranges) : ranges_(ranges) { center(); }

  void event(std::uint16_t type, std::uint16_t code, std::int32_t value);
  /// From now on the enable button has no effect until it is pressed again.
  void stop() noexcept { enabled_ = false; }
  /// Any event has come.
  void heard(std::int64_t now_ns) noexcept { heard_ns_ = now_ns; }
  /// The enable button is held with a stick away from rest, and no event has come for kSilence_ns.
  bool silent(std::int64_t now_ns) const;
  /// Full deflection commands `scale` times kFullSpeed; a silent gamepad commands zero. Nothing:
  /// the enable button is not held.
  std::optional<VelocityCommand> command(double scale, std::int64_t now_ns) const;

 private:
  void center();
  double deflection(std::size_t axis) const;  // -1 to 1, zero around the rest position

  std::array<AxisRange, 3> ranges_;
  std::array<int, 3> values_{};
  bool enabled_ = false;
  std::int64_t heard_ns_ = 0;
};

}  // namespace sandrunner::ctl
