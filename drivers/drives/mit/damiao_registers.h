// SPDX-License-Identifier: BSD-3-Clause
// Settings of Damiao's drives, read and written over CAN: the protection against a host with other
// limits than the drive's, and the way to the drive's command timeout.
//
// Source: Damiao manuals, "register list"; github.com/enactic/openarm_can and
// github.com/jia-xie/python-damiao-driver, which agree.
//
// Request: standard id 0x7FF, motor id (2 bytes, little-endian), operation, register, value (4
// bytes, little-endian). The reply has the same bytes and comes with the id of the drive's replies,
// as its states do, from which it can not be told with certainty: a state whose position code is
// 0x0033 or 0x0055 looks alike. Read a frame as a register only while an answer is awaited, before
// the motor is enabled, and ask again for what matters.
#pragma once

#include <cstdint>

#include "drivers/drives/mit/mit.h"

namespace sandrunner {

inline constexpr std::uint32_t kDamiaoRegisterId = 0x7FF;

enum class DamiaoRegister : std::uint8_t {
  kReplyId = 7,
  kMotorId = 8,
  kTimeout = 9,  ///< in kDamiaoTimeoutUnit_s, 0: never; no torque after this time without a command
  kControlMode = 10,  ///< kDamiaoMitMode: the mode of mit.h
  kPositionMax = 21,  ///< MitLimits::position_rad
  kVelocityMax = 22,
  kTorqueMax = 23,
  kBitRate = 35,
};
inline constexpr double kDamiaoTimeoutUnit_s = 50e-6;
inline constexpr double kDamiaoMitMode = 1.0;

enum class DamiaoOperation : std::uint8_t {
  kRead = 0x33,
  kWrite = 0x55,         ///< until power is cut, not for good
  kRequestState = 0xCC,  ///< answered by an MitReply; moves and enables nothing. No register.
};

enum class DamiaoStatus : std::uint8_t {
  kOk,
  kBadDrive,     ///< not kDamiao, or its ids are impossible
  kBadValue,     ///< not finite, or not whole or out of range where the register is whole
  kErrorFrame,   ///< a report of the controller
  kWrongFormat,  ///< extended id, or classic where CAN FD is expected, or the reverse
  kOtherId,      ///< not the id of register requests, or not of this drive's replies
  kWrongLength,
  kOtherMotor,    ///< names another motor
  kBadOperation,  ///< neither of DamiaoOperation; a reply: neither read nor write
};

struct DamiaoAccess {
  DamiaoOperation operation = DamiaoOperation::kRead;
  DamiaoRegister reg = DamiaoRegister::kTimeout;
  double value = 0.0;  ///< whole numbers and 32-bit floats alike; 0 in a request to read
};

/// The host's request; `value` counts with kWrite alone. `frame` is left as it is unless kOk.
DamiaoStatus encode_damiao_request(const MitDrive& drive, const DamiaoAccess& access,
                                   CanFrame& frame) noexcept;
DamiaoStatus decode_damiao_reply(const MitDrive& drive, const CanFrame& frame,
                                 DamiaoAccess& access) noexcept;

/// The drive's side, for emulated drives. kRequestState is answered by encode_mit_reply().
DamiaoStatus decode_damiao_request(const MitDrive& drive, const CanFrame& frame,
                                   DamiaoAccess& access) noexcept;
DamiaoStatus encode_damiao_reply(const MitDrive& drive, const DamiaoAccess& access,
                                 CanFrame& frame) noexcept;

}  // namespace sandrunner
