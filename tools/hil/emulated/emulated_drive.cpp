// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/emulated/emulated_drive.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "rt/core/joint_pd.h"

namespace sandrunner::hil {
namespace {

constexpr double kTurn_rad = 2.0 * std::numbers::pi;
constexpr double kSupply_v = 48.0;
/// Settings of moteus' firmware as it ships: servo.default_timeout_s, servo.timeout_max_torque_Nm.
constexpr double kMoteusTimeout_s = 0.1;
constexpr double kMoteusTimeoutTorque_nm = 5.0;

}  // namespace

EmulatedDrive::EmulatedDrive(const DriveConfig& config, double timeout_s)
    : config_(config), timeout_setting_s_(timeout_s) {
  // A Damiao comes without a time-out: the host has to set one.
  if (config.mit.variant == MitVariant::kDamiao) timeout_setting_s_ = 0.0;
}

void EmulatedDrive::measure(double joint_rad, double joint_radps) noexcept {
  position_rad_ = turn() * (joint_rad - config_.zero_rad);
  velocity_radps_ = turn() * joint_radps;
}

bool EmulatedDrive::answer(const CanFrame& request, double now_s, CanFrame& reply) noexcept {
  if (faults.silent || request.error) return false;
  look_at_clock(now_s);
  return config_.protocol == Protocol::kMit ? answer_mit(request, now_s, reply)
                                            : answer_moteus(request, now_s, reply);
}

bool EmulatedDrive::deliver() noexcept {
  ++answers_;
  if (faults.lose_every > 0 && answers_ % faults.lose_every == 0) return false;
  ++replies_;
  return true;
}

void EmulatedDrive::command(const Command& wanted, double timeout_s, double now_s) noexcept {
  if (state_ == State::kOn) longest_gap_s_ = std::max(longest_gap_s_, now_s - commanded_s_);
  state_ = State::kOn;
  command_ = wanted;
  timeout_s_ = timeout_s;
  commanded_s_ = now_s;
}

void EmulatedDrive::look_at_clock(double now_s) noexcept {
  if (faults.code != 0 && state_ == State::kOn) state_ = State::kFault;
  if (state_ != State::kOn || timeout_s_ <= 0.0 || now_s - commanded_s_ <= timeout_s_) return;
  ++time_outs_;
  state_ = State::kTimedOut;
}

bool EmulatedDrive::answer_mit(const CanFrame& request, double now_s, CanFrame& reply) noexcept {
  MitDrive drive = config_.mit;
  drive.limits.position_rad *= range_factor_;
  drive.limits.velocity_radps *= range_factor_;
  drive.limits.torque_nm *= range_factor_;
  drive.limits.reply_torque_nm *= range_factor_;
  DamiaoAccess access;
  if (decode_damiao_request(drive, request, access) == DamiaoStatus::kOk) {
    ++frames_;
    if (access.operation != DamiaoOperation::kRequestState) {
      return answer_register(access, reply) && deliver();
    }
  } else {
    MitRequest wanted;
    if (decode_mit_request(drive, request, wanted) != MitStatus::kOk) return false;
    ++frames_;
    const bool damiao = drive.variant == MitVariant::kDamiao;
    if (wanted.is_special) {
      switch (wanted.special) {
        case MitSpecial::kEnable:
          // A Damiao that lost its host stays off until that is cleared.
          if (faults.code == 0 && !(damiao && state_ == State::kTimedOut)) {
            command({.max_torque_nm = config_.max_torque_nm}, timeout_setting_s_, now_s);
          }
          break;
        case MitSpecial::kDisable:
          if (!(damiao && state_ == State::kTimedOut)) state_ = State::kOff;
          break;
        case MitSpecial::kClearFault:
          state_ = State::kOff;
          break;
        case MitSpecial::kSetZero:
          break;  // nobody should
      }
    } else if (faults.control_mode != kDamiaoMitMode) {
      return false;
    } else if (state_ == State::kOn || (state_ == State::kTimedOut && !damiao)) {
      const MitCommand& c = wanted.command;
      command({c.position_rad, c.velocity_radps, c.kp_nmprad, c.kd_nmsprad, c.torque_nm,
               config_.max_torque_nm},
              timeout_setting_s_, now_s);
    }
  }
  const bool lost_host = drive.variant == MitVariant::kDamiao && state_ == State::kTimedOut;
  const MitReply state{.position_rad = position_rad_ + faults.offset_rad,
                       .velocity_radps = velocity_radps_,
                       .torque_nm = torque_nm_,
                       .bus_voltage_v = kSupply_v,
                       .temperature_degc = faults.temperature_degc,
                       .rotor_temperature_degc = faults.temperature_degc,
                       .fault = lost_host ? kDamiaoLostHost : faults.code,
                       .power = state_ == State::kOn ? MitPower::kEnabled : MitPower::kDisabled};
  return encode_mit_reply(drive, state, reply) == MitStatus::kOk && deliver();
}

bool EmulatedDrive::answer_register(const DamiaoAccess& access, CanFrame& reply) noexcept {
  DamiaoAccess told = access;
  if (access.operation == DamiaoOperation::kWrite) {
    if (access.reg == DamiaoRegister::kTimeout) {
      timeout_setting_s_ = access.value * kDamiaoTimeoutUnit_s;
    }
  } else {
    switch (access.reg) {
      case DamiaoRegister::kReplyId:
        told.value = config_.mit.reply_id;
        break;
      case DamiaoRegister::kMotorId:
        told.value = config_.mit.motor_id;
        break;
      case DamiaoRegister::kTimeout:
        told.value = std::round(timeout_setting_s_ / kDamiaoTimeoutUnit_s);
        break;
      case DamiaoRegister::kControlMode:
        told.value = faults.control_mode;
        break;
      case DamiaoRegister::kPositionMax:
        told.value = range_factor_ * config_.mit.limits.position_rad;
        break;
      case DamiaoRegister::kVelocityMax:
        told.value = range_factor_ * config_.mit.limits.velocity_radps;
        break;
      case DamiaoRegister::kTorqueMax:
        told.value = range_factor_ * config_.mit.limits.torque_nm;
        break;
      case DamiaoRegister::kBitRate:
        told.value = 0.0;
        break;
    }
  }
  return encode_damiao_reply(config_.mit, told, reply) == DamiaoStatus::kOk;
}

bool EmulatedDrive::answer_moteus(const CanFrame& request, double now_s, CanFrame& reply) noexcept {
  MoteusRequest wanted;
  if (decode_moteus_request(config_.moteus, request, wanted) != MoteusStatus::kOk) return false;
  ++frames_;
  look_at_clock(now_s);
  // A command is in force from the next turn of the drive's own loop on, after the answer.
  const State answered = state_;
  if (wanted.has_mode && wanted.mode != MoteusMode::kPosition) {
    state_ = State::kOff;  // every other mode is taken for a stop
  } else if (wanted.has_mode && (state_ == State::kOff || state_ == State::kOn)) {
    const double kp = wanted.kp_scale * config_.moteus.kp_nmprev / kTurn_rad;
    const double kd = wanted.kd_scale * config_.moteus.kd_nmsprev / kTurn_rad;
    const bool placed = !std::isnan(wanted.position_rad);
    const double most_nm =
        std::isnan(wanted.max_torque_nm) ? config_.max_torque_nm : wanted.max_torque_nm;
    const double timeout_s = wanted.watchdog_s == 0.0        ? kMoteusTimeout_s
                             : std::isnan(wanted.watchdog_s) ? 0.0
                                                             : wanted.watchdog_s;
    command({placed ? wanted.position_rad : 0.0, wanted.velocity_radps, placed ? kp : 0.0, kd,
             wanted.torque_nm, std::min(most_nm, config_.max_torque_nm)},
            timeout_s, now_s);
    look_at_clock(now_s);
  }
  constexpr std::array kModes = {MoteusMode::kStopped, MoteusMode::kPosition, MoteusMode::kTimeout,
                                 MoteusMode::kFault};
  const MoteusReply state{
      .mode = faults.code != 0 ? MoteusMode::kFault : kModes[static_cast<std::size_t>(answered)],
      .position_rad = position_rad_ + faults.offset_rad,
      .velocity_radps = velocity_radps_,
      .torque_nm = torque_nm_,
      .voltage_v = kSupply_v,
      .temperature_degc = faults.temperature_degc,
      .motor_temperature_degc = faults.temperature_degc,
      .watchdog_s = timeout_s_,
      .code = faults.code};
  if (wanted.num_reads == 0 || !wanted.address.wants_reply) return false;
  return encode_moteus_reply(config_.moteus, wanted, state, reply) == MoteusStatus::kOk &&
         deliver();
}

double EmulatedDrive::torque_nm(double now_s) noexcept {
  look_at_clock(now_s);
  torque_nm_ = 0.0;
  if (state_ == State::kOn) {
    const Command& c = command_;
    // A moteus moves its position on by the velocity until the next command.
    const double moved_rad = config_.protocol == Protocol::kMoteus
                                 ? c.velocity_radps * std::max(now_s - commanded_s_, 0.0)
                                 : 0.0;
    torque_nm_ =
        joint_torque(position_rad_ + faults.offset_rad, velocity_radps_, c.position_rad + moved_rad,
                     c.velocity_radps, c.kp_nmprad, c.kd_nmsprad, c.torque_nm);
    torque_nm_ = clamp_to(torque_nm_, -c.max_torque_nm, c.max_torque_nm);
  } else if (state_ == State::kTimedOut && config_.protocol == Protocol::kMoteus) {
    torque_nm_ = clamp_to(-config_.moteus.kd_nmsprev / kTurn_rad * velocity_radps_,
                          -kMoteusTimeoutTorque_nm, kMoteusTimeoutTorque_nm);
  }
  return torque_nm_ * turn() * (faults.reversed ? -1.0 : 1.0);
}

void EmulatedDrive::reboot() noexcept {
  state_ = State::kOff;
  if (config_.mit.variant == MitVariant::kDamiao) timeout_setting_s_ = 0.0;
}

void EmulatedDrive::scale_ranges(double factor) noexcept { range_factor_ = factor; }

void EmulatedDrive::swap_ids(EmulatedDrive& other) noexcept {
  std::swap(config_.mit.motor_id, other.config_.mit.motor_id);
  std::swap(config_.mit.reply_id, other.config_.mit.reply_id);
  std::swap(config_.moteus.id, other.config_.moteus.id);
}

bool EmulatedDrive::passive() const noexcept {
  return state_ != State::kOn || (command_.kp_nmprad == 0.0 && std::fabs(command_.torque_nm) < 0.1);
}

bool EmulatedDrive::limp() const noexcept {
  return state_ == State::kOff || state_ == State::kFault ||
         (state_ == State::kTimedOut && config_.protocol == Protocol::kMit);
}

double EmulatedDrive::kp_nmprad() const noexcept {
  return state_ == State::kOn ? command_.kp_nmprad * config_.gear * config_.gear : 0.0;
}

double EmulatedDrive::kd_nmsprad() const noexcept {
  return state_ == State::kOn ? command_.kd_nmsprad * config_.gear * config_.gear : 0.0;
}

}  // namespace sandrunner::hil
