// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "drivers/can/can_frame.h"
#include "drivers/robot/hardware_config.h"

namespace sandrunner {

/// Faults of a drive that the driver itself detects, as bits of JointState::drive_fault above the
/// low 8 bits, which are the maker's own code.
enum class DriveTrouble : std::uint64_t {
  kNone = 0,
  kNotEnabled = 1u << 8,        ///< not enabled within kEnable_s of the command to enable
  kSwitchedOff = 1u << 9,       ///< off without a command of this program: reboot, time-out,
                                ///< or the maker's tool
  kOverTemperature = 1u << 10,  ///< above HardwareConfig::temperature_limit_degc, by kTooHot_degc
  kVoltage = 1u << 11,          ///< its supply is outside the range, by kVoltageShare
  kBusOff = 1u << 12,           ///< its bus was off since the drives were enabled
  kForgotTimeout = 1u << 13,  ///< a drive that forgets_timeout() and whose supply was off, or that
                              ///< was silent for so long that it may have been. Until the next
                              ///< start, which writes it again
};
inline constexpr double kEnable_s = 0.1;

/// The drive of one joint: makes its frames and reads its replies. Only a setpoint after a time in
/// which the robot was commanded off enables the drive: a drive that comes back by itself (reboot,
/// bus-off and restart) stays off until then. Real-time safe. Example: drive_test.cpp.
class Drive {
 public:
  Drive() = default;
  Drive(const DriveConfig& config, const HardwareConfig& hardware) noexcept;

  /// The frame that keeps the drive off; it answers with its state.
  void off_frame(CanFrame& frame) noexcept;
  /// The frame for a drive that is on.
  void command_frame(const SetPoint& set_point, CanFrame& frame) const noexcept;
  /// The frame of this exchange. `set_point` null: switch the drive off. False: send nothing, as
  /// its bus was off.
  bool next_frame(const SetPoint* set_point, std::uint64_t tick, CanFrame& frame) noexcept;

  /// Reads `frame`, received in control tick `tick`, if it is a reply of this drive. False: it is
  /// not, or it is invalid (then it counts as bad()).
  bool take(const CanFrame& frame, std::uint64_t tick) noexcept;

  /// Whether `frame` is a command to this drive. The sockets do not receive their own frames, so it
  /// comes from another program.
  bool is_command(const CanFrame& frame) const noexcept;
  /// Notes a frame for which is_command() is true.
  void note_foreign_command(std::uint64_t tick) noexcept;
  /// Whether another program commanded this drive within kForeign_ticks: one of its commands was
  /// received, or the drive sent two unrequested replies within kSurplus_ticks.
  bool has_foreign_traffic(std::uint64_t tick) const noexcept { return foreign_until_ > tick; }
  static constexpr std::uint64_t kForeign_ticks = kControlHz, kSurplus_ticks = kControlHz / 100;

  /// Its bus went off: nothing is sent until the robot was commanded off.
  void lose_bus() noexcept;

  // The newest state, at the joint.
  double position_rad() const noexcept { return position_rad_; }
  double velocity_radps() const noexcept { return velocity_radps_; }
  double torque_nm() const noexcept { return torque_nm_; }
  std::uint64_t fault() const noexcept { return state_.fault | trouble_; }
  /// kOverTemperature and kVoltage, of their first limits.
  std::uint64_t warning() const noexcept { return warning_; }
  /// The last non-zero ones; may have cleared.
  std::uint64_t last_fault() const noexcept { return last_fault_; }
  std::uint64_t last_warning() const noexcept { return last_warning_; }
  std::uint64_t tick() const noexcept { return tick_; }
  double temperature_degc() const noexcept { return state_.temperature_degc; }  ///< or NaN
  double voltage_v() const noexcept { return state_.voltage_v; }                ///< or NaN

  std::uint64_t sent() const noexcept { return sent_; }
  std::uint64_t replies() const noexcept { return replies_; }
  /// Replies since the first off frame that do not report it as on.
  std::uint64_t replies_off() const noexcept { return replies_off_; }
  std::uint64_t bad() const noexcept { return bad_; }
  std::uint64_t foreign_commands() const noexcept { return foreign_commands_; }
  std::uint64_t surplus_replies() const noexcept { return surplus_; }
  bool off() const noexcept { return phase_ == Phase::kOff; }

 private:
  enum class Phase : std::uint8_t { kOff, kEnabling, kOn, kLost };

  bool has(DriveTrouble trouble) const noexcept {
    return (trouble_ & static_cast<std::uint64_t>(trouble)) != 0;
  }
  void judge_power(bool was_silent) noexcept;
  void judge_supply() noexcept;
  void expect_reply(std::uint64_t tick) noexcept;
  void judge_surplus(std::uint64_t tick) noexcept;
  void set(DriveTrouble trouble, bool on) noexcept;

  DriveConfig config_;
  DriveTerms terms_;
  double temperature_limit_degc_ = 0.0, voltage_low_v_ = 0.0, voltage_high_v_ = 0.0;

  Phase phase_ = Phase::kOff;
  std::uint64_t enabling_since_ = 0, replies_at_enable_ = 0;
  std::uint64_t unanswered_ = 0,
                asked_tick_ = 0;  // exchanges since its last reply, and their first
  bool cleared_ = false;          // its fault, with the frame before
  DriveState state_;              // the newest, at its output
  double position_rad_ = 0.0, velocity_radps_ = 0.0, torque_nm_ = 0.0;
  std::uint64_t trouble_ = 0, last_fault_ = 0, warning_ = 0, last_warning_ = 0, tick_ = 0;
  std::uint64_t sent_ = 0, replies_ = 0, replies_off_ = 0, bad_ = 0;
  // Requests that may still be answered, of this kForget_ticks and of those before. A few of the
  // bring-up may be at the start.
  std::uint64_t open_new_ = 4, open_old_ = 0, open_since_ = 0;
  std::uint64_t surplus_ = 0, surplus_tick_ = 0, foreign_commands_ = 0, foreign_until_ = 0;
};

/// The text of a joint's drive_fault or drive_warning: "rotor over temperature", "switched off by
/// itself".
std::string drive_fault_words(const DriveConfig& config, std::uint64_t fault);

}  // namespace sandrunner
