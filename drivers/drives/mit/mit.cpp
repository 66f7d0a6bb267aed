// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/drives/mit/mit.h"

#include <algorithm>
#include <cmath>

#include "drivers/drives/nearest_code.h"

namespace sandrunner {
namespace {

constexpr double kMaxBusVoltage_v = 40.0;         // Katz: VB_MAX
constexpr double kTemperatureOffset_degc = 40.0;  // CubeMars: 0 means -40 degrees
constexpr double kMaxCode8 = 255.0, kMaxCode12 = 4095.0, kMaxCode16 = 65535.0;
// Those above could be a special frame; Damiao's kClearFault is the lowest.
constexpr double kMaxTorqueCode = 0xFFA;

using Code = std::uint32_t;

Code code(double value, double min, double max, double max_code) noexcept {
  return static_cast<Code>(nearest_code((value - min) * max_code / (max - min), 0.0, max_code));
}

double value_of(Code code, double min, double max, double max_code) noexcept {
  return min + code * (max - min) / max_code;
}

std::uint8_t byte(Code code) noexcept { return static_cast<std::uint8_t>(code & 0xFF); }

bool is_positive(double value) noexcept { return value > 0.0 && std::isfinite(value); }

bool is_possible(const MitDrive& drive) noexcept {
  const MitLimits& limits = drive.limits;
  const int max_id = drive.variant == MitVariant::kDamiao ? 0xF : 0xFF;
  return drive.motor_id >= 1 && drive.motor_id <= max_id && drive.reply_id <= kMaxStandardId &&
         is_positive(limits.position_rad) && is_positive(limits.velocity_radps) &&
         is_positive(limits.torque_nm) && is_positive(limits.reply_torque_nm) &&
         is_positive(limits.kp_nmprad) && is_positive(limits.kd_nmsprad);
}

CanFrame empty_frame(const MitDrive& drive, std::uint32_t id, int length) noexcept {
  CanFrame frame;
  frame.id = id;
  frame.fd = frame.brs = drive.format == CanFormat::kFdWithBitRateSwitch;
  frame.length = static_cast<std::uint8_t>(length);
  return frame;
}

MitStatus check_frame(const MitDrive& drive, const CanFrame& frame, std::uint32_t id,
                      int length) noexcept {
  if (!is_possible(drive)) return MitStatus::kBadDrive;
  if (frame.error) return MitStatus::kErrorFrame;
  const bool wants_fd = drive.format == CanFormat::kFdWithBitRateSwitch;
  if (frame.extended || frame.fd != wants_fd) return MitStatus::kWrongFormat;
  if (frame.id != id) return MitStatus::kOtherId;
  if (frame.length != length) return MitStatus::kWrongLength;
  return MitStatus::kOk;
}

int reply_length(MitVariant variant) noexcept {
  switch (variant) {
    case MitVariant::kOriginal:
      return 6;
    case MitVariant::kBusVoltage:
      return 7;
    case MitVariant::kCubeMars:
    case MitVariant::kDamiao:
      break;
  }
  return 8;
}

// What Damiao's manual lists.
bool is_damiao_state(std::uint8_t state) noexcept {
  return state <= 1 || state == 5 || state == 6 || (state >= 0x8 && state <= 0xE);
}

}  // namespace

const char* mit_fault_words(MitVariant variant, std::uint8_t fault) noexcept {
  if (fault == 0) return "";
  if (variant != MitVariant::kDamiao) return "drive fault";
  switch (fault) {
    case 0x5:
      return "sensor";
    case 0x6:
      return "parameters";
    case 0x8:
      return "over-voltage";
    case 0x9:
      return "under-voltage";
    case 0xA:
      return "over-current";
    case 0xB:
      return "over-temperature of the board";
    case 0xC:
      return "over-temperature of the motor";
    case kDamiaoLostHost:
      return "no commands in time";
    case 0xE:
      return "overload";
    default:
      return "unknown state";
  }
}

MitStatus encode_mit_command(const MitDrive& drive, const SetPoint& command,
                             CanFrame& frame) noexcept {
  if (!is_possible(drive)) return MitStatus::kBadDrive;
  for (const double value : {command.position_rad, command.velocity_radps, command.kp_nmprad,
                             command.kd_nmsprad, command.torque_nm}) {
    if (!std::isfinite(value)) return MitStatus::kNotFinite;
  }
  const MitLimits& limits = drive.limits;
  const Code p = code(command.position_rad, -limits.position_rad, limits.position_rad, kMaxCode16);
  const Code v =
      code(command.velocity_radps, -limits.velocity_radps, limits.velocity_radps, kMaxCode12);
  const Code kp = code(command.kp_nmprad, 0.0, limits.kp_nmprad, kMaxCode12);
  const Code kd = code(command.kd_nmsprad, 0.0, limits.kd_nmsprad, kMaxCode12);
  const Code t = std::min(code(command.torque_nm, -limits.torque_nm, limits.torque_nm, kMaxCode12),
                          static_cast<Code>(kMaxTorqueCode));
  frame = empty_frame(drive, drive.motor_id, 8);
  frame.data[0] = byte(p >> 8);
  frame.data[1] = byte(p);
  frame.data[2] = byte(v >> 4);
  frame.data[3] = byte(v << 4 | kp >> 8);
  frame.data[4] = byte(kp);
  frame.data[5] = byte(kd >> 4);
  frame.data[6] = byte(kd << 4 | t >> 8);
  frame.data[7] = byte(t);
  return MitStatus::kOk;
}

MitStatus encode_mit_special(const MitDrive& drive, MitSpecial special, CanFrame& frame) noexcept {
  if (!is_possible(drive)) return MitStatus::kBadDrive;
  frame = empty_frame(drive, drive.motor_id, 8);
  std::fill_n(frame.data.begin(), 7, std::uint8_t{0xFF});
  frame.data[7] = static_cast<std::uint8_t>(special);
  return MitStatus::kOk;
}

MitStatus decode_mit_reply(const MitDrive& drive, const CanFrame& frame, MitReply& reply) noexcept {
  const MitStatus status = check_frame(drive, frame, drive.reply_id, reply_length(drive.variant));
  if (status != MitStatus::kOk && status != MitStatus::kWrongLength) return status;
  const bool is_damiao = drive.variant == MitVariant::kDamiao;
  const Code motor = is_damiao ? frame.data[0] & 0xF : frame.data[0];
  // Before the length: drives share an identifier, and only one of them sent this.
  if (frame.length == 0 || motor != drive.motor_id) return MitStatus::kOtherMotor;
  if (status != MitStatus::kOk) return status;

  const auto& data = frame.data;
  const MitLimits& limits = drive.limits;
  reply = {};
  reply.position_rad =
      value_of(Code{data[1]} << 8 | data[2], -limits.position_rad, limits.position_rad, kMaxCode16);
  reply.velocity_radps = value_of(Code{data[3]} << 4 | data[4] >> 4, -limits.velocity_radps,
                                  limits.velocity_radps, kMaxCode12);
  reply.torque_nm = value_of((Code{data[4]} & 0xF) << 8 | data[5], -limits.reply_torque_nm,
                             limits.reply_torque_nm, kMaxCode12);
  switch (drive.variant) {
    case MitVariant::kOriginal:
      break;
    case MitVariant::kBusVoltage:
      reply.bus_voltage_v = value_of(data[6], 0.0, kMaxBusVoltage_v, kMaxCode8);
      break;
    case MitVariant::kCubeMars:
      reply.temperature_degc = data[6] - kTemperatureOffset_degc;
      reply.fault = data[7];
      break;
    case MitVariant::kDamiao: {
      const auto state = static_cast<std::uint8_t>(data[0] >> 4);
      reply.temperature_degc = data[6];
      reply.rotor_temperature_degc = data[7];
      reply.power = state == 1 ? MitPower::kEnabled : MitPower::kDisabled;
      reply.fault = state > 1 ? state : 0;
      if (!is_damiao_state(state)) return MitStatus::kUnknownState;
      break;
    }
  }
  return MitStatus::kOk;
}

MitStatus decode_mit_request(const MitDrive& drive, const CanFrame& frame,
                             MitRequest& request) noexcept {
  const MitStatus status = check_frame(drive, frame, drive.motor_id, 8);
  if (status != MitStatus::kOk) return status;
  const auto& data = frame.data;
  request = {};
  request.is_special =
      std::all_of(data.begin(), data.begin() + 7, [](std::uint8_t b) { return b == 0xFF; }) &&
      data[7] >= static_cast<std::uint8_t>(MitSpecial::kClearFault) &&
      data[7] <= static_cast<std::uint8_t>(MitSpecial::kSetZero);
  if (request.is_special) {
    request.special = static_cast<MitSpecial>(data[7]);
    return MitStatus::kOk;
  }
  const MitLimits& limits = drive.limits;
  SetPoint& command = request.command;
  command.position_rad =
      value_of(Code{data[0]} << 8 | data[1], -limits.position_rad, limits.position_rad, kMaxCode16);
  command.velocity_radps = value_of(Code{data[2]} << 4 | data[3] >> 4, -limits.velocity_radps,
                                    limits.velocity_radps, kMaxCode12);
  command.kp_nmprad =
      value_of((Code{data[3]} & 0xF) << 8 | data[4], 0.0, limits.kp_nmprad, kMaxCode12);
  command.kd_nmsprad =
      value_of(Code{data[5]} << 4 | data[6] >> 4, 0.0, limits.kd_nmsprad, kMaxCode12);
  command.torque_nm = value_of((Code{data[6]} & 0xF) << 8 | data[7], -limits.torque_nm,
                               limits.torque_nm, kMaxCode12);
  return MitStatus::kOk;
}

MitStatus encode_mit_reply(const MitDrive& drive, const MitReply& reply, CanFrame& frame) noexcept {
  if (!is_possible(drive)) return MitStatus::kBadDrive;
  const bool has_voltage = drive.variant == MitVariant::kBusVoltage;
  const bool has_temperature =
      drive.variant == MitVariant::kCubeMars || drive.variant == MitVariant::kDamiao;
  const bool has_rotor = drive.variant == MitVariant::kDamiao;
  for (const double value :
       {reply.position_rad, reply.velocity_radps, reply.torque_nm,
        has_voltage ? reply.bus_voltage_v : 0.0, has_temperature ? reply.temperature_degc : 0.0,
        has_rotor ? reply.rotor_temperature_degc : 0.0}) {
    if (!std::isfinite(value)) return MitStatus::kNotFinite;
  }
  const MitLimits& limits = drive.limits;
  const Code p = code(reply.position_rad, -limits.position_rad, limits.position_rad, kMaxCode16);
  const Code v =
      code(reply.velocity_radps, -limits.velocity_radps, limits.velocity_radps, kMaxCode12);
  const Code t = code(reply.torque_nm, -limits.reply_torque_nm, limits.reply_torque_nm, kMaxCode12);
  frame = empty_frame(drive, drive.reply_id, reply_length(drive.variant));
  auto& data = frame.data;
  data[0] = byte(drive.motor_id);
  data[1] = byte(p >> 8);
  data[2] = byte(p);
  data[3] = byte(v >> 4);
  data[4] = byte(v << 4 | t >> 8);
  data[5] = byte(t);
  switch (drive.variant) {
    case MitVariant::kOriginal:
      break;
    case MitVariant::kBusVoltage:
      data[6] = byte(code(reply.bus_voltage_v, 0.0, kMaxBusVoltage_v, kMaxCode8));
      break;
    case MitVariant::kCubeMars:
      data[6] =
          byte(code(reply.temperature_degc + kTemperatureOffset_degc, 0.0, kMaxCode8, kMaxCode8));
      data[7] = reply.fault;
      break;
    case MitVariant::kDamiao: {
      const Code state = reply.fault != 0 ? reply.fault : reply.power == MitPower::kEnabled;
      data[0] = byte(state << 4 | drive.motor_id);
      data[6] = byte(code(reply.temperature_degc, 0.0, kMaxCode8, kMaxCode8));
      data[7] = byte(code(reply.rotor_temperature_degc, 0.0, kMaxCode8, kMaxCode8));
      break;
    }
  }
  return MitStatus::kOk;
}

}  // namespace sandrunner
