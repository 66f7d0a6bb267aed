// SPDX-License-Identifier: BSD-3-Clause
// The register protocol of mjbots' moteus controllers: a CAN FD frame is a sequence of subframes,
// each of which writes, reads, or answers registers that lie next to each other, in one of four
// number formats. Both directions have the same subframes.
//
// Source: github.com/mjbots/moteus, docs/protocol/can.md and docs/protocol/registers.md (register
// map version 5).
//
// Values here are in the protocol's own units: revolutions, revolutions/s, N m, V, degrees Celsius,
// s, A; NaN is "unset", which integers say by their most negative number.
#pragma once

#include <cstdint>
#include <span>

#include "drivers/can/can_frame.h"

namespace sandrunner {

enum class MoteusFormat : std::uint8_t { kInt8, kInt16, kInt32, kFloat };

/// What a subframe does. Numbers are the protocol's first byte, of those with values without the
/// format and the count.
enum class MoteusOperation : std::uint8_t {
  kWrite = 0x00,
  kRead = 0x10,
  kReply = 0x20,
  kWriteError = 0x30,  ///< the drive did not take a value
  kReadError = 0x31,   ///< the drive does not know a register
};

using MoteusRegister = std::uint16_t;
namespace moteus_register {
inline constexpr MoteusRegister kMode = 0x000, kPosition = 0x001, kVelocity = 0x002,
                                kTorque = 0x003, kMotorTemperature = 0x00A, kVoltage = 0x00D,
                                kTemperature = 0x00E, kFault = 0x00F, kCommandPosition = 0x020,
                                kCommandVelocity = 0x021, kCommandTorque = 0x022,
                                kCommandKpScale = 0x023, kCommandKdScale = 0x024,
                                kCommandMaxTorque = 0x025, kCommandWatchdog = 0x027,
                                kMapVersion = 0x102;
}  // namespace moteus_register

/// The map that this is written for; what kMapVersion answers.
inline constexpr int kMoteusMapVersion = 5;

enum class MoteusStatus : std::uint8_t {
  kOk,
  kNotFinite,        ///< a value to be sent is NaN or infinite: no frame was made
  kBadValue,         ///< a value to be sent makes no sense: no frame was made
  kBadDrive,         ///< id or gains of the drive are impossible: no frame was made
  kTooLong,          ///< more than a frame holds
  kErrorFrame,       ///< a report of the controller, no frame of a drive
  kWrongFormat,      ///< not CAN FD
  kOtherId,          ///< from or to another device
  kTruncated,        ///< the frame ends within a subframe
  kUnknownSubframe,  ///< its first byte is none of the protocol's, or of its serial stream
  kBadNumber,        ///< a count or register number that can not be
  kWrongDirection,   ///< a command where a reply is expected, or the reverse
  kRegisterError,    ///< the drive did not take a value, or does not know a register
  kBadMode,          ///< a mode that is not in MoteusMode
  kIncomplete,       ///< a register that is needed is missing, or unset
};

/// Registers next to each other that are to be read, answered in `format`.
struct MoteusRead {
  MoteusRegister start = 0;
  std::uint8_t count = 0;
  MoteusFormat format = MoteusFormat::kInt8;
};

// --- who and to whom ---

struct MoteusAddress {
  std::uint8_t source = 0;       ///< 0 to 127; the host's is usually 0
  std::uint8_t destination = 0;  ///< 0 to 127; a drive's is 1 to 126, 127 is all
  bool wants_reply = false;
  std::uint16_t prefix = 0;  ///< 13 bits, of buses shared with others
};
/// The identifier; whether the frame is extended. Commands that want a reply always are.
void set_moteus_address(const MoteusAddress& address, CanFrame& frame) noexcept;
MoteusAddress moteus_address(const CanFrame& frame) noexcept;

// --- writing ---

/// Puts subframes into a frame. What does not fit, or has an impossible count, makes the whole
/// frame bad, which finish() tells.
class MoteusWriter {
 public:
  /// Clears the frame's data; makes it CAN FD with bit rate switch.
  explicit MoteusWriter(CanFrame& frame) noexcept;

  /// `operation`: kWrite or kReply. Values beyond the range of a format are clamped to it; what is
  /// not finite becomes unset.
  void values(MoteusOperation operation, MoteusFormat format, MoteusRegister start,
              std::span<const double> values) noexcept;
  void read(const MoteusRead& read) noexcept;
  /// `operation`: kWriteError or kReadError.
  void error(MoteusOperation operation, MoteusRegister reg, std::uint32_t code) noexcept;

  /// Fills up to a length that CAN FD has. False: not all fitted, do not send this.
  [[nodiscard]] bool finish() noexcept;

 private:
  void byte(std::uint32_t value) noexcept;
  void number(std::uint32_t value) noexcept;
  void header(MoteusOperation operation, MoteusFormat format, std::size_t count,
              MoteusRegister start) noexcept;

  CanFrame& frame_;
  int length_ = 0;
  bool fits_ = true;
};

// --- reading ---

/// One register as a subframe names it.
struct MoteusItem {
  MoteusOperation operation = MoteusOperation::kWrite;
  MoteusFormat format = MoteusFormat::kInt8;
  MoteusRegister reg = 0;
  double value = 0.0;  ///< NaN: unset, or kRead; an error's code
};

/// Goes through the registers of a frame's subframes. Takes any bytes.
class MoteusReader {
 public:
  explicit MoteusReader(const CanFrame& frame) noexcept;

  /// The next one; false at the end of the frame, or where it can not be read on: see status().
  bool next(MoteusItem& item) noexcept;
  MoteusStatus status() const noexcept { return status_; }

 private:
  bool stop(MoteusStatus status) noexcept;
  bool number(std::uint32_t& value) noexcept;
  bool start_subframe() noexcept;
  bool value(double& value) noexcept;

  const CanFrame& frame_;
  int length_;
  int at_ = 0;
  std::uint32_t remaining_ = 0;  // registers of this subframe that are still to come
  MoteusItem item_;
  MoteusStatus status_ = MoteusStatus::kOk;
};

}  // namespace sandrunner
