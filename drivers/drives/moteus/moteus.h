// SPDX-License-Identifier: BSD-3-Clause
// mjbots' moteus as joint drives: commands and replies in SI units. Both directions: the host's,
// and the drive's, which emulated drives and tests speak. Pure functions; nothing is sent.
//
// Source: github.com/mjbots/moteus, docs/protocol/registers.md (register map version 5) and
// docs/guides/control-modes.md; its firmware where those leave something open.
//
// In position mode the drive gives kp kp_scale (position - q) + kd kd_scale (velocity - qd) +
// torque, within +-max_torque; kp and kd are its settings servo.pid_position.kp and .kd, in N m a
// revolution. To behave as that law says, a drive needs these settings too: pid_position.ki = 0, no
// velocity or acceleration limit (default_velocity_limit, default_accel_limit = nan).
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "drivers/drives/moteus/moteus_frame.h"

namespace sandrunner {

/// One drive on a bus, and how it is spoken to.
struct MoteusDrive {
  static constexpr const char* kProtocol = "moteus";

  std::uint8_t id = 1;  ///< 1 to 126
  std::uint8_t host_id = 0;
  std::uint16_t prefix = 0;  ///< 13 bits, the drive's setting can.prefix
  /// Of commands with set-points. kInt16: positions to +-3.2767 revolutions in steps of 1e-4.
  MoteusFormat format = MoteusFormat::kInt16;
  double kp_nmprev = 0.0;      ///< the drive's servo.pid_position.kp
  double kd_nmsprev = 0.0;     ///< the drive's servo.pid_position.kd
  double max_torque_nm = 0.0;  ///< most that a command may ask for
};

/// Register 0x000.
enum class MoteusMode : std::uint8_t {
  kStopped,
  kFault,
  kEnabling,
  kCalibrating,
  kCalibrationComplete,
  kPwm,
  kVoltage,
  kVoltageFoc,
  kVoltageDq,
  kCurrent,
  kPosition,
  kTimeout,  ///< no command in time: damping, until it is stopped
  kZeroVelocity,
  kStayWithin,
  kMeasureInductance,
  kBrake,
};
inline constexpr int kNumMoteusModes = 16;

/// What a code of register 0x00F means, "" for 0.
const char* moteus_fault_words(std::uint8_t code) noexcept;

struct MoteusCommand {
  double position_rad = 0.0;    ///< does not count with kp 0
  double velocity_radps = 0.0;  ///< also moves the position on until the next command
  double kp_nmprad = 0.0;       ///< not above the drive's own; nor is kd
  double kd_nmsprad = 0.0;
  double torque_nm = 0.0;
  double max_torque_nm = 0.0;  ///< of the whole
  /// For how long the command holds; 0: the drive's setting servo.default_timeout_s, 0.1 s as it is
  /// delivered. Else 1 ms to 30 s: "for ever" can not be said.
  double watchdog_s = 0.0;
};

/// What decode_moteus_reply() needs and what it can tell.
inline constexpr MoteusRead kMoteusState[] = {{moteus_register::kMode, 1, MoteusFormat::kInt8},
                                              {moteus_register::kPosition, 3, MoteusFormat::kInt16},
                                              {moteus_register::kVoltage, 3, MoteusFormat::kInt8}};

struct MoteusReply {
  MoteusMode mode = MoteusMode::kStopped;
  double position_rad = std::numeric_limits<double>::quiet_NaN();
  double velocity_radps = std::numeric_limits<double>::quiet_NaN();
  double torque_nm = std::numeric_limits<double>::quiet_NaN();
  /// NaN where not asked for.
  double voltage_v = std::numeric_limits<double>::quiet_NaN();
  double temperature_degc = std::numeric_limits<double>::quiet_NaN();  ///< of the board
  double motor_temperature_degc = std::numeric_limits<double>::quiet_NaN();
  double watchdog_s = std::numeric_limits<double>::quiet_NaN();  ///< of the command that holds
  /// Register 0x00F: a fault if `mode` is kFault, else at most a limit.
  std::uint8_t code = 0;
};

// --- the host's side ---
// `reads` is what the drive is to answer: nothing, and no answer comes. `frame` is meant to be sent
// with kOk alone.

/// Gains above the drive's own are clamped to those, set-points to what the format holds. With kp
/// 0 the position is left unset; the drive damps by kd. (The register's documentation says that a
/// kd scale above the kp scale is cut to it; firmware does not: mode kZeroVelocity relies on that.)
MoteusStatus encode_moteus_position(const MoteusDrive& drive, const MoteusCommand& command,
                                    std::span<const MoteusRead> reads, CanFrame& frame) noexcept;

/// Torque alone, both gains 0, within the drive's own limit: the shortest command. `watchdog_s` as
/// in MoteusCommand.
MoteusStatus encode_moteus_torque(const MoteusDrive& drive, double torque_nm, double watchdog_s,
                                  std::span<const MoteusRead> reads, CanFrame& frame) noexcept;

/// No torque; ends kFault and kTimeout.
MoteusStatus encode_moteus_stop(const MoteusDrive& drive, std::span<const MoteusRead> reads,
                                CanFrame& frame) noexcept;

/// Asks, and changes nothing: does not count as a command to the drive's watchdog.
MoteusStatus encode_moteus_query(const MoteusDrive& drive, std::span<const MoteusRead> reads,
                                 CanFrame& frame) noexcept;

/// Reads a frame as this drive's reply. Mode, position, velocity and torque must be there and set.
/// `reply` is whole with kOk, else left as it is.
MoteusStatus decode_moteus_reply(const MoteusDrive& drive, const CanFrame& frame,
                                 MoteusReply& reply) noexcept;

// --- the drive's side ---

/// What a drive was sent. Set-points have the values of a drive that was not told them.
struct MoteusRequest {
  static constexpr int kMaxReads = 8;

  MoteusAddress address;
  bool has_mode = false;  ///< else only reads, or registers without a mode, which do nothing
  MoteusMode mode = MoteusMode::kStopped;
  double position_rad = 0.0;  ///< NaN: where the drive is
  double velocity_radps = 0.0;
  double torque_nm = 0.0;
  double kp_scale = 1.0;
  double kd_scale = 1.0;
  double max_torque_nm = std::numeric_limits<double>::quiet_NaN();  ///< NaN: the drive's own limit
  double watchdog_s = 0.0;  ///< 0: the drive's setting; NaN: none
  std::array<MoteusRead, kMaxReads> reads{};
  int num_reads = 0;
};
MoteusStatus decode_moteus_request(const MoteusDrive& drive, const CanFrame& frame,
                                   MoteusRequest& request) noexcept;

/// Answers the reads of a request: fields of `state`, the map's version, and "unknown register" for
/// the others. What does not fit is kTooLong.
MoteusStatus encode_moteus_reply(const MoteusDrive& drive, const MoteusRequest& request,
                                 const MoteusReply& state, CanFrame& frame) noexcept;

}  // namespace sandrunner
