// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "drivers/drives/moteus/moteus.h"
#include "tools/hil/emulated/drive_core.h"

namespace sandrunner::hil {

/// What a moteus answers. After its time-out it is in mode "timeout", in which it damps until it is
/// stopped.
class EmulatedMoteus {
 public:
  explicit EmulatedMoteus(const MoteusDrive& drive) noexcept : drive_(drive) {}

  bool answer(DriveCore& core, const CanFrame& request, double now_s, CanFrame& reply) noexcept;
  TimedOut timed_out() const noexcept;
  /// Whether it moves a commanded position on by the velocity.
  static constexpr bool kMovesOn = true;

  void reboot() noexcept {}
  void scale_ranges(double) noexcept {}  // its values have units
  void swap_ids(EmulatedMoteus& other) noexcept;

 private:
  void obey(DriveCore& core, const MoteusRequest& wanted, double now_s) const noexcept;

  MoteusDrive drive_;
};

inline EmulatedMoteus emulate(const MoteusDrive& drive, double) { return EmulatedMoteus(drive); }

}  // namespace sandrunner::hil
