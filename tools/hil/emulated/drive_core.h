// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "drivers/drives/drive_family.h"

namespace sandrunner::hil {

/// What is wrong with an emulated drive.
struct DriveFaults {
  bool silent = false;      ///< hears nothing and says nothing
  int lose_every = 0;       ///< of its replies one in this many is lost; 0: none
  std::uint8_t code = 0;    ///< its own fault: it gives no torque
  double offset_rad = 0.0;  ///< its encoder says so much more, at its output
  double temperature_degc = 35.0;
  bool reversed = false;      ///< its torque acts the other way than it says
  bool untimed = false;       ///< it never times out: it keeps to its last command
  double control_mode = 1.0;  ///< a Damiao's: in another than 1 it heeds no set-points
};

/// What emulated drives of all families have: a state, the newest command and the encoder, at the
/// drive's output.
struct DriveCore {
  enum class State : std::uint8_t { kOff, kOn, kTimedOut, kFault };

  static constexpr double kSupply_v = 48.0;

  DriveFaults faults;
  double max_torque_nm = 0.0;  ///< that it can give

  State state = State::kOff;
  SetPoint commanded;
  double commanded_most_nm = 0.0;  ///< of the whole law
  double commanded_s = 0.0;        ///< when
  double timeout_s = 0.0;          ///< of that command; 0: none
  double position_rad = 0.0, velocity_radps = 0.0, torque_nm = 0.0;

  double longest_gap_s = 0.0;  ///< of commands while it was on
  std::uint64_t frames = 0, replies = 0, time_outs = 0, answers = 0;

  double measured_rad() const noexcept { return position_rad + faults.offset_rad; }
  /// A command that is in force from now on.
  void command(const SetPoint& wanted, double most_nm, double wanted_timeout_s,
               double now_s) noexcept;
  /// Its fault and its time-out take effect.
  void look_at_clock(double now_s) noexcept;
  /// Counts an answer. False: it gets lost.
  bool deliver() noexcept;
};

/// What a drive that timed out does.
struct TimedOut {
  double kd_nmsprad = 0.0;     ///< it damps by this; 0: it is limp
  double max_torque_nm = 0.0;  ///< by which at most
};

}  // namespace sandrunner::hil
