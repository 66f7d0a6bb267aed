// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/drives/mit/mit_drive.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <string_view>

#include "drivers/drives/mit/damiao_registers.h"
#include "drivers/drives/mit/mit_models.h"
#include "rt/base/errors.h"

namespace sandrunner {
namespace {

constexpr std::uint8_t kUnknownFault = 0xFF;

struct Model {
  std::string name;
};
constexpr Setting<Model> kModel[] = {
    {"model", &Model::name, "mit: the drive's model; a wrong name makes the message list them all.",
     kRequired},
};
constexpr Setting<MitDrive> kReply[] = {
    {"reply_id", &MitDrive::reply_id, 0, 0x7FE, "mit: identifier of its replies (master id)."},
};
constexpr const char* kOfTheModel = "the model's";
using L = MitLimits;
constexpr Setting<L> kRanges[] = {
    {"position_rad", &L::position_rad, 0.1, 1e3, "mit: range of its positions.", kOfTheModel},
    {"velocity_radps", &L::velocity_radps, 0.1, 1e3, "mit: range of its velocities.", kOfTheModel},
    {"torque_nm", &L::torque_nm, 0.1, 1e3, "mit: range of the torques of commands.", kOfTheModel},
};
constexpr Setting<L> kReplyRange[] = {
    {"reply_torque_nm", &L::reply_torque_nm, 0.1, 1e3, "mit: range of the torques of replies.",
     "torque_nm"},
};

bool is_damiao(const MitDrive& drive) noexcept { return drive.variant == MitVariant::kDamiao; }

/// No code means zero: a drive at rest reports half a step. Left as it is, a joint that stands
/// would seem to creep for ever.
double without_half_step(double velocity_radps, double limit_radps) noexcept {
  const double step_radps = 2.0 * limit_radps / 4095.0;
  return std::fabs(velocity_radps) < 0.51 * step_radps ? 0.0 : velocity_radps;
}

DriveQuestion question(const MitDrive& drive, const char* what, DamiaoOperation operation,
                       DamiaoRegister reg, double expected) {
  DriveQuestion question{.what = what,
                         .source = fmt::format("register {}", static_cast<int>(reg)),
                         .expected = expected,
                         .request = {},
                         .answer = {}};
  encode_damiao_request(drive, {.operation = operation, .reg = reg, .value = expected},
                        question.request);
  question.answer = [drive, reg](const CanFrame& frame) -> std::optional<double> {
    DamiaoAccess reply;
    if (decode_damiao_reply(drive, frame, reply) != DamiaoStatus::kOk || reply.reg != reg) {
      return std::nullopt;
    }
    return reply.value;
  };
  return question;
}

}  // namespace

CanFormats can_formats(const MitDrive&) noexcept { return {.classic = true, .fd = true}; }

void set_address(MitDrive& drive, int id, CanFormat format) noexcept {
  drive.motor_id = static_cast<std::uint16_t>(id);
  drive.format = format;
}

void read_drive(MitDrive& drive, ConfigTree& t, const std::string& where) {
  Model wanted;
  read_settings(t, "", kModel, wanted);
  const std::string& name = wanted.name;
  const MitModel* const model = find_mit_model(name);
  if (model == nullptr) {
    std::vector<std::string_view> names;
    for (const MitModel& m : mit_models()) names.push_back(m.name);
    throw InputError(
        fmt::format("{}: model '{}', expected one of {}", where, name, fmt::join(names, ", ")));
  }
  drive.variant = model->variant;
  if (drive.format != CanFormat::kClassic && !is_damiao(drive)) {
    throw InputError(fmt::format(
        "{}: {} speaks classic CAN alone, its bus is set to CAN FD (fd = true)", where, name));
  }
  if (is_damiao(drive) && drive.motor_id > 15) {
    throw InputError(fmt::format("{}: id {}, but a Damiao names only 1 to 15 in its replies", where,
                                 drive.motor_id));
  }
  drive.reply_id = 0;
  read_settings(t, "", kReply, drive);
  // The ranges may have been changed in the drive.
  drive.limits = model->limits;
  read_settings(t, "", kRanges, drive.limits);
  drive.limits.reply_torque_nm = drive.limits.torque_nm;
  read_settings(t, "", kReplyRange, drive.limits);
}

void list_drive_settings(const MitDrive&, std::vector<SettingLine>& lines,
                         const std::string& table) {
  list_settings(lines, table, kModel, kReply, kRanges, kReplyRange);
}

int drive_id(const MitDrive& drive) noexcept { return drive.motor_id; }

std::optional<std::uint32_t> reply_id(const MitDrive& drive) noexcept { return drive.reply_id; }

DriveRanges drive_ranges(const MitDrive& drive) noexcept {
  const MitLimits& l = drive.limits;
  return {l.position_rad, l.velocity_radps, l.torque_nm, l.kp_nmprad, l.kd_nmsprad};
}

bool forgets_timeout(const MitDrive& drive) noexcept { return is_damiao(drive); }

bool hides_timeout(const MitDrive& drive) noexcept { return !is_damiao(drive); }

std::vector<DriveQuestion> drive_questions(const MitDrive& drive, double timeout_s) {
  if (!is_damiao(drive)) return {};
  const double timeout = std::round(timeout_s / kDamiaoTimeoutUnit_s);
  const auto read = [&](const char* what, DamiaoRegister reg, double expected) {
    return question(drive, what, DamiaoOperation::kRead, reg, expected);
  };
  const char* const timeout_words = "time-out (units of 50 us)";
  return {
      // In another mode it lets itself be enabled, and follows a target of its own.
      read("control mode (1: MIT)", DamiaoRegister::kControlMode, kDamiaoMitMode),
      read("position range (PMAX)", DamiaoRegister::kPositionMax, drive.limits.position_rad),
      read("velocity range (VMAX)", DamiaoRegister::kVelocityMax, drive.limits.velocity_radps),
      read("torque range (TMAX)", DamiaoRegister::kTorqueMax, drive.limits.torque_nm),
      question(drive, timeout_words, DamiaoOperation::kWrite, DamiaoRegister::kTimeout, timeout),
      // The answer to a write may be an echo.
      read(timeout_words, DamiaoRegister::kTimeout, timeout),
  };
}

void encode_off(const MitDrive& drive, bool clear_fault, CanFrame& frame) noexcept {
  encode_mit_special(drive, clear_fault ? MitSpecial::kClearFault : MitSpecial::kDisable, frame);
}

void encode_enable(const MitDrive& drive, const DriveTerms&, CanFrame& frame) noexcept {
  encode_mit_special(drive, MitSpecial::kEnable, frame);
}

void encode_command(const MitDrive& drive, const SetPoint& command, const DriveTerms&,
                    CanFrame& frame) noexcept {
  encode_mit_command(drive, command, frame);
}

void encode_probe(const MitDrive& drive, CanFrame& frame) noexcept {
  MitDrive any = drive;
  any.limits.velocity_radps = any.limits.torque_nm = any.limits.reply_torque_nm = 1.0;
  encode_mit_special(any, MitSpecial::kDisable, frame);
}

bool is_probe_reply(const MitDrive& drive, const CanFrame& frame) noexcept {
  if (frame.error || frame.extended) return false;
  if (frame.length < 6 || frame.length > kMaxClassicBytes) return false;
  const int id = is_damiao(drive) ? frame.data[0] & 0xF : frame.data[0];
  return id == drive.motor_id;
}

ReplyKind decode_state(const MitDrive& drive, const CanFrame& frame, DriveState& state) noexcept {
  MitReply reply;
  const MitStatus status = decode_mit_reply(drive, frame, reply);
  if (status == MitStatus::kWrongLength) return ReplyKind::kBad;
  const bool unknown = status == MitStatus::kUnknownState;
  if (status != MitStatus::kOk && !unknown) return ReplyKind::kOther;
  state = {.position_rad = reply.position_rad,
           .velocity_radps = without_half_step(reply.velocity_radps, drive.limits.velocity_radps),
           .torque_nm = reply.torque_nm,
           .temperature_degc = std::fmax(reply.temperature_degc, reply.rotor_temperature_degc),
           .voltage_v = reply.bus_voltage_v,
           .fault = unknown ? kUnknownFault : reply.fault};
  if (reply.power != MitPower::kUnknown) {
    state.power = reply.power == MitPower::kEnabled ? DrivePower::kOn : DrivePower::kOff;
  }
  state.locked = is_damiao(drive) && state.fault == kDamiaoLostHost;
  return ReplyKind::kState;
}

bool is_command_to(const MitDrive& drive, const CanFrame& frame) noexcept {
  if (frame.error) return false;
  DamiaoAccess access;
  return (!frame.extended && frame.id == drive.motor_id) ||
         decode_damiao_request(drive, frame, access) == DamiaoStatus::kOk;
}

const char* fault_words(const MitDrive& drive, std::uint8_t code) noexcept {
  return mit_fault_words(drive.variant, code);
}

std::string describe(const MitDrive& drive, const CanFrame& frame) {
  MitRequest r;
  if (decode_mit_request(drive, frame, r) != MitStatus::kOk) return "no frame of this drive";
  if (r.is_special) return r.special == MitSpecial::kEnable ? "enable" : "off";
  return describe(r.command);
}

void encode_example_reply(const MitDrive& drive, const CanFrame&, CanFrame& frame) noexcept {
  MitReply state;
  state.bus_voltage_v = state.temperature_degc = state.rotor_temperature_degc = 0.0;
  encode_mit_reply(drive, state, frame);
}

}  // namespace sandrunner
