// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/drives/mit/damiao_registers.h"

#include <bit>
#include <cmath>
#include <limits>

namespace sandrunner {
namespace {

// The others are 32-bit floats.
bool is_whole(DamiaoRegister reg) noexcept {
  const auto number = static_cast<std::uint8_t>(reg);
  return (number >= 7 && number <= 10) || (number >= 13 && number <= 16) || number == 35 ||
         number == 36;
}

bool is_a_damiao(const MitDrive& drive) noexcept {
  return drive.variant == MitVariant::kDamiao && drive.motor_id >= 1 && drive.motor_id <= 0xF &&
         drive.reply_id <= kMaxStandardId;
}

// The four bytes of a value; false if the register can not hold it.
bool value_bits(const DamiaoAccess& access, std::uint32_t& bits) noexcept {
  if (!std::isfinite(access.value)) return false;
  if (!is_whole(access.reg)) {
    if (std::fabs(access.value) > std::numeric_limits<float>::max()) return false;
    bits = std::bit_cast<std::uint32_t>(static_cast<float>(access.value));
    return true;
  }
  constexpr double kMax = std::numeric_limits<std::uint32_t>::max();
  if (access.value < 0.0 || access.value > kMax || std::floor(access.value) != access.value) {
    return false;
  }
  bits = static_cast<std::uint32_t>(access.value);
  return true;
}

DamiaoStatus encode(const MitDrive& drive, const DamiaoAccess& access, std::uint32_t id,
                    bool with_value, CanFrame& frame) noexcept {
  if (!is_a_damiao(drive)) return DamiaoStatus::kBadDrive;
  std::uint32_t bits = 0;
  if (with_value && !value_bits(access, bits)) return DamiaoStatus::kBadValue;
  frame = {};
  frame.id = id;
  frame.fd = frame.brs = drive.format == CanFormat::kFdWithBitRateSwitch;
  frame.length = 8;
  frame.data[0] = static_cast<std::uint8_t>(drive.motor_id);
  frame.data[2] = static_cast<std::uint8_t>(access.operation);
  if (access.operation != DamiaoOperation::kRequestState) {
    frame.data[3] = static_cast<std::uint8_t>(access.reg);
  }
  for (int i = 0; i < 4; ++i) frame.data[4 + i] = static_cast<std::uint8_t>(bits >> 8 * i);
  return DamiaoStatus::kOk;
}

DamiaoStatus decode(const MitDrive& drive, const CanFrame& frame, std::uint32_t id,
                    DamiaoAccess& access) noexcept {
  if (!is_a_damiao(drive)) return DamiaoStatus::kBadDrive;
  if (frame.error) return DamiaoStatus::kErrorFrame;
  const bool wants_fd = drive.format == CanFormat::kFdWithBitRateSwitch;
  if (frame.extended || frame.fd != wants_fd) return DamiaoStatus::kWrongFormat;
  if (frame.id != id) return DamiaoStatus::kOtherId;
  if (frame.length != 8) return DamiaoStatus::kWrongLength;
  if ((frame.data[1] << 8 | frame.data[0]) != drive.motor_id) return DamiaoStatus::kOtherMotor;
  DamiaoAccess read;
  read.operation = static_cast<DamiaoOperation>(frame.data[2]);
  if (read.operation != DamiaoOperation::kRead && read.operation != DamiaoOperation::kWrite &&
      read.operation != DamiaoOperation::kRequestState) {
    return DamiaoStatus::kBadOperation;
  }
  read.reg = static_cast<DamiaoRegister>(frame.data[3]);
  std::uint32_t bits = 0;
  for (int i = 0; i < 4; ++i) bits |= std::uint32_t{frame.data[4 + i]} << 8 * i;
  read.value = is_whole(read.reg) ? static_cast<double>(bits)
                                  : static_cast<double>(std::bit_cast<float>(bits));
  if (!std::isfinite(read.value)) return DamiaoStatus::kBadValue;
  access = read;
  return DamiaoStatus::kOk;
}

}  // namespace

DamiaoStatus encode_damiao_request(const MitDrive& drive, const DamiaoAccess& access,
                                   CanFrame& frame) noexcept {
  const bool with_value = access.operation == DamiaoOperation::kWrite;
  return encode(drive, access, kDamiaoRegisterId, with_value, frame);
}

DamiaoStatus decode_damiao_reply(const MitDrive& drive, const CanFrame& frame,
                                 DamiaoAccess& access) noexcept {
  DamiaoAccess read;
  const DamiaoStatus status = decode(drive, frame, drive.reply_id, read);
  if (status != DamiaoStatus::kOk) return status;
  if (read.operation == DamiaoOperation::kRequestState) return DamiaoStatus::kBadOperation;
  access = read;
  return DamiaoStatus::kOk;
}

DamiaoStatus decode_damiao_request(const MitDrive& drive, const CanFrame& frame,
                                   DamiaoAccess& access) noexcept {
  return decode(drive, frame, kDamiaoRegisterId, access);
}

DamiaoStatus encode_damiao_reply(const MitDrive& drive, const DamiaoAccess& access,
                                 CanFrame& frame) noexcept {
  if (access.operation == DamiaoOperation::kRequestState) return DamiaoStatus::kBadOperation;
  return encode(drive, access, drive.reply_id, true, frame);
}

}  // namespace sandrunner
