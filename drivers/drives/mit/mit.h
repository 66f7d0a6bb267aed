// SPDX-License-Identifier: BSD-3-Clause
// The frames of the MIT Mini Cheetah's drives, which CubeMars, Damiao and many others took over:
// one command frame to a motor, one reply. Both directions: the host's, and the drive's, which
// emulated drives and tests speak. Pure functions; nothing is sent.
//
// Source: B. Katz, github.com/bgkatz/motorcontrol, Core/Src/can.c; CubeMars AK series manual 1.0.8,
// "MIT mode"; Damiao DM-J4310 manual, "MIT mode" and "feedback frame".
//
// Command, 8 bytes, to the standard id of the motor, most significant bits first: position 16 bits,
// velocity 12, kp 12, kd 12, torque 12. A code c of n bits means min + c (max - min) / (2^n - 1).
// Zero has no code of its own in a symmetric range: velocity 0 is sent as half a step below.
// Reply, to the id of the host: motor id, position 16, velocity 12, torque 12; then see MitVariant.
// Positions beyond the range are clamped by the drive, or wrap, depending on the firmware.
#pragma once

#include <cstdint>
#include <limits>

#include "drivers/can/can_frame.h"
#include "drivers/drives/drive_family.h"

namespace sandrunner {

/// What a drive's codes span. They are the drive's configuration as much as the host's: with others
/// than the drive's, every value is wrong by a factor and nothing says so. Drives that can tell
/// theirs are asked (damiao_registers.h).
struct MitLimits {
  double position_rad = 12.5;  ///< from minus this to this; likewise the next three
  double velocity_radps = 0.0;
  double torque_nm = 0.0;        ///< of a command
  double reply_torque_nm = 0.0;  ///< of a reply; Katz' firmware may be built with another one
  double kp_nmprad = 500.0;      ///< from 0 to this
  double kd_nmsprad = 5.0;       ///< from 0 to this
};

/// What follows the torque in a reply, and what byte 0 holds.
enum class MitVariant : std::uint8_t {
  kOriginal,    ///< 6 bytes: nothing follows
  kBusVoltage,  ///< 7 bytes: bus voltage, 0 to 40 V (Katz' present firmware)
  kCubeMars,    ///< 8 bytes: temperature + 40 degrees, fault code
  kDamiao,      ///< 8 bytes: temperatures of board and rotor; byte 0 is state << 4 | motor id
};

/// One drive on a bus, and how it is spoken to.
struct MitDrive {
  static constexpr const char* kProtocol = "mit";

  std::uint16_t motor_id = 1;  ///< of commands: 1 to 255, with kDamiao to 15
  std::uint16_t reply_id = 0;  ///< of replies: often the same for all motors, byte 0 then tells
  MitVariant variant = MitVariant::kOriginal;
  CanFormat format = CanFormat::kClassic;  ///< kDamiao: its CAN FD variant has the same bytes
  MitLimits limits;
};

/// Commands that are no set-point: seven bytes FF and one of these. A drive answers each with a
/// reply. CubeMars: there is no frame that only asks for the state.
enum class MitSpecial : std::uint8_t {
  kClearFault = 0xFB,  ///< Damiao
  kEnable = 0xFC,
  kDisable = 0xFD,
  kSetZero = 0xFE,  ///< the present position becomes 0. Never while the motor carries load.
};

enum class MitStatus : std::uint8_t {
  kOk,
  kNotFinite,    ///< a value to be sent is NaN or infinite: no frame was made
  kBadDrive,     ///< ids or limits of the drive are impossible: no frame was made
  kErrorFrame,   ///< a report of the controller, no frame of a drive
  kWrongFormat,  ///< extended id, or classic where CAN FD is expected, or the reverse
  kOtherId,      ///< the frame's id is not this drive's
  kWrongLength,
  kOtherMotor,    ///< byte 0 names another motor
  kUnknownState,  ///< Damiao: a state that its manual does not list. The other fields are read.
};

/// Damiao says in each reply whether it is enabled, the others do not.
enum class MitPower : std::uint8_t { kUnknown, kDisabled, kEnabled };

struct MitReply {
  double position_rad = 0.0;
  double velocity_radps = 0.0;
  double torque_nm = 0.0;
  /// NaN where the variant does not have it.
  double bus_voltage_v = std::numeric_limits<double>::quiet_NaN();
  double temperature_degc = std::numeric_limits<double>::quiet_NaN();        ///< of the board
  double rotor_temperature_degc = std::numeric_limits<double>::quiet_NaN();  ///< Damiao
  std::uint8_t fault = 0;  ///< the drive's code, 0: none. See mit_fault_words().
  MitPower power = MitPower::kUnknown;
};

/// A Damiao's fault code after its time-out: off, and not to be enabled until that is cleared.
inline constexpr std::uint8_t kDamiaoLostHost = 0xD;

/// What a fault code means, "" for 0. CubeMars' manuals number theirs differently from version to
/// version, so only its presence is reported.
const char* mit_fault_words(MitVariant variant, std::uint8_t fault) noexcept;

// --- the host's side ---

/// Values beyond the limits are clamped. With anything not finite `frame` is left as it is.
/// The torque code stops five short of the highest, so that no command, however saturated, can be
/// a special frame.
MitStatus encode_mit_command(const MitDrive& drive, const SetPoint& command,
                             CanFrame& frame) noexcept;
MitStatus encode_mit_special(const MitDrive& drive, MitSpecial special, CanFrame& frame) noexcept;

/// Reads a frame as the reply of this drive; `reply` is whole with kOk and kUnknownState, else left
/// as it is.
MitStatus decode_mit_reply(const MitDrive& drive, const CanFrame& frame, MitReply& reply) noexcept;

// --- the drive's side ---

/// What a drive was sent: a special frame or a command.
struct MitRequest {
  bool is_special = false;
  MitSpecial special = MitSpecial::kDisable;  ///< if is_special
  SetPoint command;                           ///< else
};
MitStatus decode_mit_request(const MitDrive& drive, const CanFrame& frame,
                             MitRequest& request) noexcept;

/// What the variant does not carry is left out; values beyond the limits are clamped.
MitStatus encode_mit_reply(const MitDrive& drive, const MitReply& reply, CanFrame& frame) noexcept;

}  // namespace sandrunner
