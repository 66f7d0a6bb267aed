// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <variant>

#include "drivers/robot/hardware_config.h"
#include "tools/hil/emulated/drive_core.h"
#include "tools/hil/emulated/emulated_mit.h"
#include "tools/hil/emulated/emulated_moteus.h"

namespace sandrunner::hil {

/// A motor drive at the other end of a CAN bus: what it answers, and its torque, by its own time
/// and its own encoder. Frames in, frames out; no clock and no I/O. Time is in s since any start.
/// After its time-out without a command it acts as its family does: off, or damping.
class EmulatedDrive {
 public:
  using State = DriveCore::State;

  /// `timeout_s`: the setting of a drive that is not told its time-out over CAN.
  EmulatedDrive(const DriveConfig& config, double timeout_s);

  /// Its joint is now here, and this fast.
  void measure(double joint_rad, double joint_radps) noexcept;

  /// Takes a frame that came at `now_s`. True: `reply` is its answer.
  bool answer(const CanFrame& request, double now_s, CanFrame& reply) noexcept;

  /// What it gives now, at the joint, N m.
  double torque_nm(double now_s) noexcept;

  /// Power was off and is on again.
  void reboot() noexcept;
  /// Its codes span this times what is configured, as those of another model would.
  void scale_ranges(double factor) noexcept;
  /// It has the other's identifiers from now on, and the other its.
  void swap_ids(EmulatedDrive& other) noexcept;

  DriveFaults& faults() noexcept { return core_.faults; }
  const DriveFaults& faults() const noexcept { return core_.faults; }
  State state() const noexcept { return core_.state; }
  /// Neither a stiffness nor a torque of its own: off, timed out, or damping.
  bool passive() const noexcept;
  /// Gives no torque at all.
  bool limp() const noexcept;
  /// The gains of its last command at the joint, N m/rad and N m s/rad; 0 if it has none.
  double kp_nmprad() const noexcept;
  double kd_nmsprad() const noexcept;

  std::uint64_t frames() const noexcept { return core_.frames; }    ///< meant for it
  std::uint64_t replies() const noexcept { return core_.replies; }  ///< not those that were lost
  std::uint64_t time_outs() const noexcept { return core_.time_outs; }
  /// Of commands while it was on.
  double longest_gap_s() const noexcept { return core_.longest_gap_s; }

 private:
  double turn() const noexcept { return sign_ * gear_; }
  TimedOut timed_out() const noexcept;

  double sign_, gear_, zero_rad_;
  DriveCore core_;
  std::variant<EmulatedMit, EmulatedMoteus> family_;
};

}  // namespace sandrunner::hil
