// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/drives/moteus/moteus.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sandrunner {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kUnset = std::numeric_limits<double>::quiet_NaN();
constexpr double kMinWatchdog_s = 1e-3, kMaxWatchdog_s = 30.0;
constexpr std::uint32_t kUnknownRegister = 1;

bool is_possible(const MoteusDrive& drive) noexcept {
  return drive.id >= 1 && drive.id <= 126 && drive.host_id <= 127 && drive.prefix <= 0x1FFF &&
         (drive.format == MoteusFormat::kInt16 || drive.format == MoteusFormat::kFloat);
}

// A gain as a share of the drive's own; false: the drive has none.
bool gain_scale(double gain, double own_gain, double& scale) noexcept {
  scale = gain == 0.0 ? 0.0 : std::clamp(gain / own_gain, 0.0, 1.0);
  return gain == 0.0 || own_gain > 0.0;
}

// A command to the drive: mode first if there is one, then what `write` adds, then the reads.
template <typename Write>
MoteusStatus encode(const MoteusDrive& drive, std::span<const MoteusRead> reads, CanFrame& frame,
                    const Write& write) noexcept {
  if (!is_possible(drive)) return MoteusStatus::kBadDrive;
  set_moteus_address({drive.host_id, drive.id, !reads.empty(), drive.prefix}, frame);
  MoteusWriter writer(frame);
  write(writer);
  for (const MoteusRead& read : reads) writer.read(read);
  return writer.finish() ? MoteusStatus::kOk : MoteusStatus::kTooLong;
}

bool possible_watchdog(double watchdog_s) noexcept {
  return watchdog_s == 0.0 || (watchdog_s >= kMinWatchdog_s && watchdog_s <= kMaxWatchdog_s);
}

void write_watchdog(MoteusWriter& writer, MoteusFormat format, double watchdog_s) noexcept {
  if (watchdog_s == 0.0) return;
  const double values[] = {watchdog_s};
  writer.values(MoteusOperation::kWrite, format, moteus_register::kCommandWatchdog, values);
}

void write_mode(MoteusWriter& writer, MoteusMode mode) noexcept {
  const double value[] = {static_cast<double>(mode)};
  writer.values(MoteusOperation::kWrite, MoteusFormat::kInt8, moteus_register::kMode, value);
}

// Whether a frame can be read, whose address is `concerned` by this drive: first of all, as another
// node's is none of its business.
MoteusStatus check_frame(const MoteusDrive& drive, const CanFrame& frame, bool concerned) noexcept {
  if (!is_possible(drive)) return MoteusStatus::kBadDrive;
  if (frame.error) return MoteusStatus::kErrorFrame;
  if (!concerned) return MoteusStatus::kOtherId;
  return frame.fd ? MoteusStatus::kOk : MoteusStatus::kWrongFormat;
}

// Calls `take` with each register of this drive's reply.
template <typename Take>
MoteusStatus each_register(const MoteusDrive& drive, const CanFrame& frame,
                           const Take& take) noexcept {
  const MoteusAddress address = moteus_address(frame);
  const bool concerned = address.source == drive.id && address.destination == drive.host_id &&
                         address.prefix == drive.prefix && !address.wants_reply;
  if (const MoteusStatus status = check_frame(drive, frame, concerned);
      status != MoteusStatus::kOk) {
    return status;
  }
  MoteusReader reader(frame);
  MoteusItem item;
  MoteusStatus status = MoteusStatus::kOk;
  while (reader.next(item)) {
    switch (item.operation) {
      case MoteusOperation::kReply:
        take(item);
        break;
      case MoteusOperation::kWriteError:
      case MoteusOperation::kReadError:
        status = MoteusStatus::kRegisterError;
        break;
      default:
        return MoteusStatus::kWrongDirection;
    }
  }
  return reader.status() != MoteusStatus::kOk ? reader.status() : status;
}

bool to_mode(double value, MoteusMode& mode) noexcept {
  if (!(value >= 0.0 && value < kNumMoteusModes) || std::floor(value) != value) return false;
  mode = static_cast<MoteusMode>(value);
  return true;
}

}  // namespace

const char* words(MoteusMode mode) noexcept {
  switch (mode) {
    case MoteusMode::kStopped:
      return "stopped";
    case MoteusMode::kFault:
      return "fault";
    case MoteusMode::kEnabling:
      return "enabling";
    case MoteusMode::kCalibrating:
      return "calibrating";
    case MoteusMode::kCalibrationComplete:
      return "calibration complete";
    case MoteusMode::kPwm:
      return "PWM";
    case MoteusMode::kVoltage:
      return "voltage";
    case MoteusMode::kVoltageFoc:
      return "voltage FOC";
    case MoteusMode::kVoltageDq:
      return "voltage DQ";
    case MoteusMode::kCurrent:
      return "current";
    case MoteusMode::kPosition:
      return "position";
    case MoteusMode::kTimeout:
      return "timeout";
    case MoteusMode::kZeroVelocity:
      return "zero velocity";
    case MoteusMode::kStayWithin:
      return "stay within";
    case MoteusMode::kMeasureInductance:
      return "measure inductance";
    case MoteusMode::kBrake:
      return "brake";
  }
  return "unknown mode";
}

const char* moteus_fault_words(std::uint8_t code) noexcept {
  switch (code) {
    case 0:
      return "";
    case 32:
      return "calibration fault";
    case 33:
      return "motor driver fault";
    case 34:
      return "over-voltage";
    case 35:
      return "encoder fault";
    case 36:
      return "motor not configured";
    case 37:
      return "PWM cycle overrun";
    case 38:
      return "over-temperature";
    case 39:
      return "outside position limit";
    case 40:
      return "under-voltage";
    case 41:
      return "configuration changed";
    case 42:
      return "theta invalid";
    case 43:
      return "position invalid";
    case 44:
      return "driver enable fault";
    case 45:
      return "stop position deprecated";
    case 46:
      return "timing violation";
    case 47:
      return "back-EMF feed-forward without acceleration limit";
    case 48:
      return "invalid limits";
    case 49:
      return "position control error";
    case 50:
      return "velocity control error";
    case 96:
      return "limited by velocity";
    case 97:
      return "limited by power";
    case 98:
      return "limited by system voltage";
    case 99:
      return "limited by current";
    case 100:
      return "limited by board temperature";
    case 101:
      return "limited by motor temperature";
    case 102:
      return "limited by the commanded torque";
    case 103:
      return "limited by position";
    default:
      return "unknown code";
  }
}

MoteusStatus encode_moteus_position(const MoteusDrive& drive, const MoteusCommand& command,
                                    std::span<const MoteusRead> reads, CanFrame& frame) noexcept {
  for (const double value :
       {command.position_rad, command.velocity_radps, command.kp_nmprad, command.kd_nmsprad,
        command.torque_nm, command.max_torque_nm, command.watchdog_s}) {
    if (!std::isfinite(value)) return MoteusStatus::kNotFinite;
  }
  if (command.kp_nmprad < 0.0 || command.kd_nmsprad < 0.0 || command.max_torque_nm < 0.0 ||
      !possible_watchdog(command.watchdog_s)) {
    return MoteusStatus::kBadValue;
  }
  double kp_scale = 0.0, kd_scale = 0.0;
  if (!gain_scale(command.kp_nmprad * kTwoPi, drive.kp_nmprev, kp_scale) ||
      !gain_scale(command.kd_nmsprad * kTwoPi, drive.kd_nmsprev, kd_scale)) {
    return MoteusStatus::kBadDrive;
  }
  const double values[] = {command.kp_nmprad == 0.0 ? kUnset : command.position_rad / kTwoPi,
                           command.velocity_radps / kTwoPi,
                           command.torque_nm,
                           kp_scale,
                           kd_scale,
                           command.max_torque_nm};
  return encode(drive, reads, frame, [&](MoteusWriter& writer) {
    write_mode(writer, MoteusMode::kPosition);
    writer.values(MoteusOperation::kWrite, drive.format, moteus_register::kCommandPosition, values);
    write_watchdog(writer, drive.format, command.watchdog_s);
  });
}

MoteusStatus encode_moteus_torque(const MoteusDrive& drive, double torque_nm, double watchdog_s,
                                  std::span<const MoteusRead> reads, CanFrame& frame) noexcept {
  if (!std::isfinite(torque_nm) || !std::isfinite(watchdog_s)) return MoteusStatus::kNotFinite;
  if (!possible_watchdog(watchdog_s)) return MoteusStatus::kBadValue;
  const double values[] = {torque_nm, 0.0, 0.0};
  return encode(drive, reads, frame, [&](MoteusWriter& writer) {
    write_mode(writer, MoteusMode::kPosition);
    writer.values(MoteusOperation::kWrite, drive.format, moteus_register::kCommandTorque, values);
    write_watchdog(writer, drive.format, watchdog_s);
  });
}

MoteusStatus encode_moteus_stop(const MoteusDrive& drive, std::span<const MoteusRead> reads,
                                CanFrame& frame) noexcept {
  return encode(drive, reads, frame,
                [](MoteusWriter& writer) { write_mode(writer, MoteusMode::kStopped); });
}

MoteusStatus encode_moteus_query(const MoteusDrive& drive, std::span<const MoteusRead> reads,
                                 CanFrame& frame) noexcept {
  return encode(drive, reads, frame, [](MoteusWriter&) {});
}

MoteusStatus decode_moteus_reply(const MoteusDrive& drive, const CanFrame& frame,
                                 MoteusReply& reply) noexcept {
  MoteusReply read;
  double mode = kUnset, code = 0.0;
  const MoteusStatus status = each_register(drive, frame, [&](const MoteusItem& item) {
    switch (item.reg) {
      case moteus_register::kMode:
        mode = item.value;
        break;
      case moteus_register::kPosition:
        read.position_rad = item.value * kTwoPi;
        break;
      case moteus_register::kVelocity:
        read.velocity_radps = item.value * kTwoPi;
        break;
      case moteus_register::kTorque:
        read.torque_nm = item.value;
        break;
      case moteus_register::kMotorTemperature:
        read.motor_temperature_degc = item.value;
        break;
      case moteus_register::kVoltage:
        read.voltage_v = item.value;
        break;
      case moteus_register::kTemperature:
        read.temperature_degc = item.value;
        break;
      case moteus_register::kFault:
        code = item.value;
        break;
      case moteus_register::kCommandWatchdog:
        read.watchdog_s = item.value;
        break;
      default:
        break;
    }
  });
  if (status != MoteusStatus::kOk) return status;
  if (std::isnan(mode) || !std::isfinite(read.position_rad) ||
      !std::isfinite(read.velocity_radps) || !std::isfinite(read.torque_nm)) {
    return MoteusStatus::kIncomplete;
  }
  if (!to_mode(mode, read.mode)) return MoteusStatus::kBadMode;
  if (!(code >= 0.0 && code <= 255.0) || std::floor(code) != code) return MoteusStatus::kBadNumber;
  read.code = static_cast<std::uint8_t>(code);
  reply = read;
  return MoteusStatus::kOk;
}

MoteusStatus decode_moteus_request(const MoteusDrive& drive, const CanFrame& frame,
                                   MoteusRequest& request) noexcept {
  MoteusRequest read;
  read.address = moteus_address(frame);
  constexpr std::uint8_t kEverybody = 127;
  const bool concerned =
      read.address.prefix == drive.prefix &&
      (read.address.destination == drive.id || read.address.destination == kEverybody);
  if (const MoteusStatus status = check_frame(drive, frame, concerned);
      status != MoteusStatus::kOk) {
    return status;
  }
  MoteusReader reader(frame);
  MoteusItem item;
  while (reader.next(item)) {
    if (item.operation == MoteusOperation::kRead) {
      MoteusRead* const last = read.num_reads > 0 ? &read.reads[read.num_reads - 1] : nullptr;
      if (last != nullptr && last->format == item.format && last->start + last->count == item.reg &&
          last->count < kMaxFdBytes) {
        ++last->count;
      } else if (read.num_reads < MoteusRequest::kMaxReads) {
        read.reads[read.num_reads++] = {item.reg, 1, item.format};
      } else {
        return MoteusStatus::kTooLong;
      }
      continue;
    }
    if (item.operation != MoteusOperation::kWrite) return MoteusStatus::kWrongDirection;
    switch (item.reg) {
      case moteus_register::kMode: {
        // As the firmware does it: a mode forgets every set-point that was written before it.
        MoteusRequest fresh;
        fresh.address = read.address;
        fresh.reads = read.reads;
        fresh.num_reads = read.num_reads;
        fresh.has_mode = true;
        if (!to_mode(item.value, fresh.mode)) return MoteusStatus::kBadMode;
        read = fresh;
        break;
      }
      case moteus_register::kCommandPosition:
        read.position_rad = item.value * kTwoPi;
        break;
      case moteus_register::kCommandVelocity:
        read.velocity_radps = std::isnan(item.value) ? 0.0 : item.value * kTwoPi;
        break;
      case moteus_register::kCommandTorque:
        read.torque_nm = item.value;
        break;
      case moteus_register::kCommandKpScale:
        read.kp_scale = item.value;
        break;
      case moteus_register::kCommandKdScale:
        read.kd_scale = item.value;
        break;
      case moteus_register::kCommandMaxTorque:
        read.max_torque_nm = item.value;
        break;
      case moteus_register::kCommandWatchdog:
        read.watchdog_s = item.value;
        break;
      default:
        break;
    }
  }
  if (reader.status() != MoteusStatus::kOk) return reader.status();
  request = read;
  return MoteusStatus::kOk;
}

MoteusStatus encode_moteus_reply(const MoteusDrive& drive, const MoteusRequest& request,
                                 const MoteusReply& state, CanFrame& frame) noexcept {
  if (!is_possible(drive)) return MoteusStatus::kBadDrive;
  // False for registers that it does not know.
  const auto value_of = [&](MoteusRegister reg, double& value) {
    switch (reg) {
      case moteus_register::kMode:
        value = static_cast<double>(state.mode);
        return true;
      case moteus_register::kPosition:
        value = state.position_rad / kTwoPi;
        return true;
      case moteus_register::kVelocity:
        value = state.velocity_radps / kTwoPi;
        return true;
      case moteus_register::kTorque:
        value = state.torque_nm;
        return true;
      case moteus_register::kMotorTemperature:
        value = state.motor_temperature_degc;
        return true;
      case moteus_register::kVoltage:
        value = state.voltage_v;
        return true;
      case moteus_register::kTemperature:
        value = state.temperature_degc;
        return true;
      case moteus_register::kFault:
        value = state.code;
        return true;
      case moteus_register::kCommandWatchdog:
        value = state.watchdog_s;
        return true;
      case moteus_register::kMapVersion:
        value = kMoteusMapVersion;
        return true;
      default:
        return false;
    }
  };
  set_moteus_address({drive.id, request.address.source, false, drive.prefix}, frame);
  MoteusWriter writer(frame);
  for (int i = 0; i < request.num_reads; ++i) {
    const MoteusRead& read = request.reads[i];
    std::array<double, kMaxFdBytes> values{};
    int count = 0;
    const auto flush = [&](int end) {
      if (count == 0) return;
      writer.values(MoteusOperation::kReply, read.format,
                    static_cast<MoteusRegister>(read.start + end - count),
                    std::span(values).first(count));
      count = 0;
    };
    for (int k = 0; k < read.count && k < kMaxFdBytes; ++k) {
      const auto reg = static_cast<MoteusRegister>(read.start + k);
      if (value_of(reg, values[count])) {
        ++count;
      } else {
        flush(k);
        writer.error(MoteusOperation::kReadError, reg, kUnknownRegister);
      }
    }
    flush(read.count);
  }
  return writer.finish() ? MoteusStatus::kOk : MoteusStatus::kTooLong;
}

}  // namespace sandrunner
