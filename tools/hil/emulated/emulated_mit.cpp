// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/emulated/emulated_mit.h"

#include <cmath>
#include <utility>

namespace sandrunner::hil {

using State = DriveCore::State;

EmulatedMit::EmulatedMit(const MitDrive& drive, double timeout_s)
    : drive_(drive),
      limits_(drive.limits),
      timeout_s_(drive.variant == MitVariant::kDamiao ? 0.0 : timeout_s) {}

bool EmulatedMit::answer(DriveCore& core, const CanFrame& request, double now_s,
                         CanFrame& reply) noexcept {
  DamiaoAccess access;
  if (decode_damiao_request(drive_, request, access) == DamiaoStatus::kOk) {
    ++core.frames;
    if (access.operation != DamiaoOperation::kRequestState) {
      return answer_register(core, access, reply) && core.deliver();
    }
  } else {
    MitRequest wanted;
    if (decode_mit_request(drive_, request, wanted) != MitStatus::kOk) return false;
    ++core.frames;
    if (!wanted.is_special && core.faults.control_mode != kDamiaoMitMode) return false;
    obey(core, wanted, now_s);
  }
  const bool lost_host = is_damiao() && core.state == State::kTimedOut;
  const MitReply state{
      .position_rad = core.measured_rad(),
      .velocity_radps = core.velocity_radps,
      .torque_nm = core.torque_nm,
      .bus_voltage_v = DriveCore::kSupply_v,
      .temperature_degc = core.faults.temperature_degc,
      .rotor_temperature_degc = core.faults.temperature_degc,
      .fault = lost_host ? kDamiaoLostHost : core.faults.code,
      .power = core.state == State::kOn ? MitPower::kEnabled : MitPower::kDisabled};
  return encode_mit_reply(drive_, state, reply) == MitStatus::kOk && core.deliver();
}

void EmulatedMit::obey(DriveCore& core, const MitRequest& wanted, double now_s) noexcept {
  const bool locked = is_damiao() && core.state == State::kTimedOut;
  if (!wanted.is_special) {
    if (core.state == State::kOn || (core.state == State::kTimedOut && !locked)) {
      core.command(wanted.command, core.max_torque_nm, timeout_s_, now_s);
    }
    return;
  }
  switch (wanted.special) {
    case MitSpecial::kEnable:
      if (core.faults.code == 0 && !locked) core.command({}, core.max_torque_nm, timeout_s_, now_s);
      break;
    case MitSpecial::kDisable:
      if (!locked) core.state = State::kOff;
      break;
    case MitSpecial::kClearFault:
      core.state = State::kOff;
      break;
    case MitSpecial::kSetZero:
      break;  // nobody should
  }
}

bool EmulatedMit::answer_register(const DriveCore& core, const DamiaoAccess& access,
                                  CanFrame& reply) noexcept {
  DamiaoAccess told = access;
  if (access.operation == DamiaoOperation::kWrite) {
    if (access.reg == DamiaoRegister::kTimeout) timeout_s_ = access.value * kDamiaoTimeoutUnit_s;
  } else {
    switch (access.reg) {
      case DamiaoRegister::kReplyId:
        told.value = drive_.reply_id;
        break;
      case DamiaoRegister::kMotorId:
        told.value = drive_.motor_id;
        break;
      case DamiaoRegister::kTimeout:
        told.value = std::round(timeout_s_ / kDamiaoTimeoutUnit_s);
        break;
      case DamiaoRegister::kControlMode:
        told.value = core.faults.control_mode;
        break;
      case DamiaoRegister::kPositionMax:
        told.value = drive_.limits.position_rad;
        break;
      case DamiaoRegister::kVelocityMax:
        told.value = drive_.limits.velocity_radps;
        break;
      case DamiaoRegister::kTorqueMax:
        told.value = drive_.limits.torque_nm;
        break;
      case DamiaoRegister::kBitRate:
        told.value = 0.0;
        break;
    }
  }
  return encode_damiao_reply(drive_, told, reply) == DamiaoStatus::kOk;
}

void EmulatedMit::reboot() noexcept {
  if (is_damiao()) timeout_s_ = 0.0;
}

void EmulatedMit::scale_ranges(double factor) noexcept {
  MitLimits& l = drive_.limits;
  l.position_rad = limits_.position_rad * factor;
  l.velocity_radps = limits_.velocity_radps * factor;
  l.torque_nm = limits_.torque_nm * factor;
  l.reply_torque_nm = limits_.reply_torque_nm * factor;
}

void EmulatedMit::swap_ids(EmulatedMit& other) noexcept {
  std::swap(drive_.motor_id, other.drive_.motor_id);
  std::swap(drive_.reply_id, other.drive_.reply_id);
}

}  // namespace sandrunner::hil
