// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/drives/moteus/moteus.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>

namespace sandrunner {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kUnset = std::numeric_limits<double>::quiet_NaN();
constexpr double kMinWatchdog_s = 1e-3, kMaxWatchdog_s = 30.0;
constexpr std::uint32_t kUnknownRegister = 1;

struct CodeWords {
  std::uint8_t code;
  const char* words;
};
constexpr CodeWords kFaultWords[] = {
    {0, ""},
    {32, "calibration fault"},
    {33, "motor driver fault"},
    {34, "over-voltage"},
    {35, "encoder fault"},
    {36, "motor not configured"},
    {37, "PWM cycle overrun"},
    {38, "over-temperature"},
    {39, "outside position limit"},
    {40, "under-voltage"},
    {41, "configuration changed"},
    {42, "theta invalid"},
    {43, "position invalid"},
    {44, "driver enable fault"},
    {45, "stop position deprecated"},
    {46, "timing violation"},
    {47, "back-EMF feed-forward without acceleration limit"},
    {48, "invalid limits"},
    {49, "position control error"},
    {50, "velocity control error"},
    {96, "limited by velocity"},
    {97, "limited by power"},
    {98, "limited by system voltage"},
    {99, "limited by current"},
    {100, "limited by board temperature"},
    {101, "limited by motor temperature"},
    {102, "limited by the commanded torque"},
    {103, "limited by position"},
};

// A register, the member that holds it in SI units, and the register's unit in these.
template <typename Values>
struct RegisterOf {
  MoteusRegister reg;
  double Values::* member;
  double factor;
};
constexpr RegisterOf<MoteusReply> kReplyRegisters[] = {
    {moteus_register::kPosition, &MoteusReply::position_rad, kTwoPi},
    {moteus_register::kVelocity, &MoteusReply::velocity_radps, kTwoPi},
    {moteus_register::kTorque, &MoteusReply::torque_nm, 1.0},
    {moteus_register::kMotorTemperature, &MoteusReply::motor_temperature_degc, 1.0},
    {moteus_register::kVoltage, &MoteusReply::voltage_v, 1.0},
    {moteus_register::kTemperature, &MoteusReply::temperature_degc, 1.0},
    {moteus_register::kCommandWatchdog, &MoteusReply::watchdog_s, 1.0},
};
constexpr RegisterOf<MoteusRequest> kRequestRegisters[] = {
    {moteus_register::kCommandPosition, &MoteusRequest::position_rad, kTwoPi},
    {moteus_register::kCommandVelocity, &MoteusRequest::velocity_radps, kTwoPi},
    {moteus_register::kCommandTorque, &MoteusRequest::torque_nm, 1.0},
    {moteus_register::kCommandKpScale, &MoteusRequest::kp_scale, 1.0},
    {moteus_register::kCommandKdScale, &MoteusRequest::kd_scale, 1.0},
    {moteus_register::kCommandMaxTorque, &MoteusRequest::max_torque_nm, 1.0},
    {moteus_register::kCommandWatchdog, &MoteusRequest::watchdog_s, 1.0},
};

/// The row of a table; null: it has no such register.
template <typename Values, std::size_t kSize>
const RegisterOf<Values>* find(const RegisterOf<Values> (&table)[kSize],
                               MoteusRegister reg) noexcept {
  const auto* const row =
      std::find_if(std::begin(table), std::end(table), [&](const auto& r) { return r.reg == reg; });
  return row == std::end(table) ? nullptr : row;
}

/// Takes a register that was read or written, if the table has it.
template <typename Values, std::size_t kSize>
void take(const RegisterOf<Values> (&table)[kSize], const MoteusItem& item,
          Values& values) noexcept {
  const RegisterOf<Values>* const row = find(table, item.reg);
  if (row != nullptr) values.*row->member = item.value * row->factor;
}

/// What a drive of this state answers; false: it does not know the register.
bool value_of(MoteusRegister reg, const MoteusReply& state, double& value) noexcept {
  if (const RegisterOf<MoteusReply>* const row = find(kReplyRegisters, reg); row != nullptr) {
    value = state.*row->member / row->factor;
    return true;
  }
  switch (reg) {
    case moteus_register::kMode:
      value = static_cast<double>(state.mode);
      return true;
    case moteus_register::kFault:
      value = state.code;
      return true;
    case moteus_register::kMapVersion:
      value = kMoteusMapVersion;
      return true;
    default:
      return false;
  }
}

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

const char* moteus_fault_words(std::uint8_t code) noexcept {
  const auto* const found = std::find_if(std::begin(kFaultWords), std::end(kFaultWords),
                                         [&](const CodeWords& row) { return row.code == code; });
  return found == std::end(kFaultWords) ? "unknown code" : found->words;
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
    if (item.reg == moteus_register::kMode) {
      mode = item.value;
    } else if (item.reg == moteus_register::kFault) {
      code = item.value;
    } else {
      take(kReplyRegisters, item, read);
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
    if (item.reg == moteus_register::kMode) {
      // As the firmware does it: a mode forgets every set-point that was written before it.
      MoteusRequest fresh;
      fresh.address = read.address;
      fresh.reads = read.reads;
      fresh.num_reads = read.num_reads;
      fresh.has_mode = true;
      if (!to_mode(item.value, fresh.mode)) return MoteusStatus::kBadMode;
      read = fresh;
    } else {
      take(kRequestRegisters, item, read);
    }
  }
  // An unset velocity is none.
  if (std::isnan(read.velocity_radps)) read.velocity_radps = 0.0;
  if (reader.status() != MoteusStatus::kOk) return reader.status();
  request = read;
  return MoteusStatus::kOk;
}

MoteusStatus encode_moteus_reply(const MoteusDrive& drive, const MoteusRequest& request,
                                 const MoteusReply& state, CanFrame& frame) noexcept {
  if (!is_possible(drive)) return MoteusStatus::kBadDrive;
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
      if (value_of(reg, state, values[count])) {
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
