// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "drivers/drives/mit/damiao_registers.h"
#include "drivers/drives/mit/mit.h"
#include "tools/hil/emulated/drive_core.h"

namespace sandrunner::hil {

/// What a drive of the MIT layout answers. After its time-out it gives no torque until the next
/// command; a Damiao is off, with the fault "communication lost", until that is cleared.
class EmulatedMit {
 public:
  /// `timeout_s`: the drive's setting. A Damiao comes without one: the host has to set it.
  EmulatedMit(const MitDrive& drive, double timeout_s);

  bool answer(DriveCore& core, const CanFrame& request, double now_s, CanFrame& reply) noexcept;
  TimedOut timed_out() const noexcept { return {}; }
  /// Whether it moves a commanded position on by the velocity.
  static constexpr bool kMovesOn = false;

  void reboot() noexcept;
  /// Its codes span this times what is configured.
  void scale_ranges(double factor) noexcept;
  void swap_ids(EmulatedMit& other) noexcept;

 private:
  bool answer_register(const DriveCore& core, const DamiaoAccess& access, CanFrame& reply) noexcept;
  void obey(DriveCore& core, const MitRequest& wanted, double now_s) noexcept;
  bool is_damiao() const noexcept { return drive_.variant == MitVariant::kDamiao; }

  MitDrive drive_;
  MitLimits limits_;  ///< as configured
  double timeout_s_;  ///< setting; 0: none
};

inline EmulatedMit emulate(const MitDrive& drive, double timeout_s) { return {drive, timeout_s}; }

}  // namespace sandrunner::hil
