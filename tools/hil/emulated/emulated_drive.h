// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "drivers/can/can_frame.h"
#include "drivers/drives/mit/damiao_registers.h"
#include "drivers/robot/hardware_config.h"

namespace sandrunner::hil {

/// What is wrong with an emulated drive.
struct DriveFaults {
  bool silent = false;      ///< hears nothing and says nothing
  int lose_every = 0;       ///< of its replies one in so many is lost; 0: none
  std::uint8_t code = 0;    ///< its own fault: it gives no torque
  double offset_rad = 0.0;  ///< its encoder says so much more, at its output
  double temperature_degc = 35.0;
  bool reversed = false;                 ///< its torque acts the other way than it says
  double control_mode = kDamiaoMitMode;  ///< a Damiao's: in another it heeds no set-points
};

/// A motor drive at the other end of a CAN bus: what it answers, and its torque, by its own time
/// and its own encoder. Frames in, frames out; no clock and no I/O. Time is in s since any start.
///
/// Without a command for its time-out it lets go: MIT layout: no torque until the next command;
/// Damiao: off with the fault "communication lost"; moteus: mode "timeout", in which it damps until
/// it is stopped.
class EmulatedDrive {
 public:
  enum class State : std::uint8_t {
    kOff,
    kOn,
    kTimedOut,
    kFault,
  };

  /// `timeout_s`: what a drive of the MIT layout has as its setting; the others are told it.
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

  State state() const noexcept { return state_; }
  /// Neither a stiffness nor a torque of its own: off, let go, or damping.
  bool passive() const noexcept;
  /// Gives no torque at all.
  bool limp() const noexcept;
  /// The gains of its last command at the joint, N m/rad and N m s/rad; 0 if it has none.
  double kp_nmprad() const noexcept;
  double kd_nmsprad() const noexcept;

  std::uint64_t frames() const noexcept { return frames_; }    ///< meant for it
  std::uint64_t replies() const noexcept { return replies_; }  ///< not those that were lost
  std::uint64_t time_outs() const noexcept { return time_outs_; }
  double longest_gap_s() const noexcept { return longest_gap_s_; }  ///< of commands while it was on

  DriveFaults faults;

 private:
  struct Command {  // at the drive's output
    double position_rad = 0.0, velocity_radps = 0.0, kp_nmprad = 0.0, kd_nmsprad = 0.0;
    double torque_nm = 0.0, max_torque_nm = 0.0;
  };

  bool answer_mit(const CanFrame& request, double now_s, CanFrame& reply) noexcept;
  bool answer_moteus(const CanFrame& request, double now_s, CanFrame& reply) noexcept;
  bool answer_register(const DamiaoAccess& access, CanFrame& reply) noexcept;
  void command(const Command& command, double timeout_s, double now_s) noexcept;
  void look_at_clock(double now_s) noexcept;
  bool deliver() noexcept;
  double turn() const noexcept { return config_.sign * config_.gear; }

  DriveConfig config_;
  double timeout_setting_s_, timeout_s_ = 0.0;  ///< 0: none
  double range_factor_ = 1.0;
  State state_ = State::kOff;
  Command command_;
  double commanded_s_ = 0.0;
  double position_rad_ = 0.0, velocity_radps_ = 0.0, torque_nm_ = 0.0;  // at its output
  double longest_gap_s_ = 0.0;
  std::uint64_t frames_ = 0, replies_ = 0, time_outs_ = 0, answers_ = 0;
};

}  // namespace sandrunner::hil
