// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/drives/moteus/moteus_drive.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "rt/base/errors.h"

namespace sandrunner {
namespace {

constexpr double kTurn_rad = 2.0 * std::numbers::pi;
// What the int16 registers hold (moteus_frame.h): 1e-4 turns, 2.5e-4 turns/s.
constexpr double kMaxPosition_rad = 32767 * 1e-4 * kTurn_rad;
constexpr double kMaxSpeed_radps = 32767 * 2.5e-4 * kTurn_rad;

using D = MoteusDrive;
constexpr Setting<D> kKeys[] = {
    {"kp_nmprev", &D::kp_nmprev, 1e-6, 1e6, "moteus: the drive's servo.pid_position.kp.",
     kRequired},
    {"kd_nmsprev", &D::kd_nmsprev, 1e-6, 1e5, "moteus: the drive's servo.pid_position.kd.",
     kRequired},
    {"max_torque_nm", &D::max_torque_nm, 1e-6, 300.0, "moteus: largest torque of a command.",
     kRequired},
};

}  // namespace

CanFormats can_formats(const MoteusDrive&) noexcept { return {.classic = false, .fd = true}; }

void set_address(MoteusDrive& drive, int id, CanFormat) noexcept {
  drive.id = static_cast<std::uint8_t>(id);
}

void read_drive(MoteusDrive& drive, ConfigTree& t, const std::string& where) {
  for (const Setting<D>& row : kKeys) {
    if (!t.has(row.key)) {
      throw InputError(fmt::format("{}: found no {}, expected that of the drive's configuration",
                                   where, row.key));
    }
    read_setting(t, row.key, row, drive);
  }
}

void list_drive_settings(const MoteusDrive&, std::vector<SettingLine>& lines,
                         const std::string& table) {
  list_settings(lines, table, kKeys);
}

int drive_id(const MoteusDrive& drive) noexcept { return drive.id; }

std::optional<std::uint32_t> reply_id(const MoteusDrive&) noexcept { return std::nullopt; }

DriveRanges drive_ranges(const MoteusDrive& drive) noexcept {
  return {kMaxPosition_rad, kMaxSpeed_radps, drive.max_torque_nm, drive.kp_nmprev / kTurn_rad,
          drive.kd_nmsprev / kTurn_rad};
}

bool forgets_timeout(const MoteusDrive&) noexcept { return false; }

bool hides_timeout(const MoteusDrive&) noexcept { return false; }

std::vector<DriveQuestion> drive_questions(const MoteusDrive&, double) { return {}; }

void encode_off(const MoteusDrive& drive, bool, CanFrame& frame) noexcept {
  encode_moteus_stop(drive, kMoteusState, frame);
}

void encode_enable(const MoteusDrive& drive, const DriveTerms& terms, CanFrame& frame) noexcept {
  encode_command(drive, {}, terms, frame);
}

void encode_command(const MoteusDrive& drive, const SetPoint& command, const DriveTerms& terms,
                    CanFrame& frame) noexcept {
  if (terms.torque_only) {
    encode_moteus_torque(drive, command.torque_nm, terms.timeout_s, kMoteusState, frame);
    return;
  }
  encode_moteus_position(drive,
                         {.position_rad = command.position_rad,
                          .velocity_radps = command.velocity_radps,
                          .kp_nmprad = command.kp_nmprad,
                          .kd_nmsprad = command.kd_nmsprad,
                          .torque_nm = command.torque_nm,
                          .max_torque_nm = terms.max_torque_nm,
                          .watchdog_s = terms.timeout_s},
                         kMoteusState, frame);
}

void encode_probe(const MoteusDrive& drive, CanFrame& frame) noexcept {
  encode_moteus_query(drive, kMoteusState, frame);
}

bool is_probe_reply(const MoteusDrive& drive, const CanFrame& frame) noexcept {
  return !frame.error && frame.fd && moteus_address(frame).source == drive.id;
}

ReplyKind decode_state(const MoteusDrive& drive, const CanFrame& frame,
                       DriveState& state) noexcept {
  MoteusReply reply;
  const MoteusStatus status = decode_moteus_reply(drive, frame, reply);
  if (status == MoteusStatus::kOtherId || status == MoteusStatus::kErrorFrame) {
    return ReplyKind::kOther;
  }
  if (status != MoteusStatus::kOk) return ReplyKind::kBad;
  const bool on = reply.mode == MoteusMode::kPosition || reply.mode == MoteusMode::kEnabling;
  state = {.position_rad = reply.position_rad,
           .velocity_radps = reply.velocity_radps,
           .torque_nm = reply.torque_nm,
           .temperature_degc = std::fmax(reply.temperature_degc, reply.motor_temperature_degc),
           .voltage_v = reply.voltage_v,
           .fault = reply.mode == MoteusMode::kFault ? reply.code : std::uint8_t{0},
           .power = on ? DrivePower::kOn : DrivePower::kOff,
           .damps = reply.mode == MoteusMode::kTimeout};
  return ReplyKind::kState;
}

bool is_command_to(const MoteusDrive& drive, const CanFrame& frame) noexcept {
  MoteusRequest request;
  return !frame.error && decode_moteus_request(drive, frame, request) == MoteusStatus::kOk;
}

const char* fault_words(const MoteusDrive&, std::uint8_t code) noexcept {
  return moteus_fault_words(code);
}

std::string describe(const MoteusDrive& drive, const CanFrame& frame) {
  MoteusRequest r;
  if (decode_moteus_request(drive, frame, r) != MoteusStatus::kOk) return "no frame of this drive";
  if (r.mode == MoteusMode::kStopped) return "off";
  const SetPoint command{r.position_rad, r.velocity_radps, r.kp_scale * drive.kp_nmprev / kTurn_rad,
                         r.kd_scale * drive.kd_nmsprev / kTurn_rad, r.torque_nm};
  return fmt::format("{}, at most {:.1f} N m, times out after {:g} s", describe(command),
                     r.max_torque_nm, r.watchdog_s);
}

void encode_example_reply(const MoteusDrive& drive, const CanFrame& command,
                          CanFrame& frame) noexcept {
  MoteusReply state;
  state.position_rad = state.velocity_radps = state.torque_nm = 0.0;
  MoteusRequest request;
  decode_moteus_request(drive, command, request);
  encode_moteus_reply(drive, request, state, frame);
}

}  // namespace sandrunner
