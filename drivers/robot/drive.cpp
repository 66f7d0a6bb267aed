// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/robot/drive.h"

#include <fmt/format.h>

#include "rt/core/warnings.h"

namespace sandrunner {
namespace {

constexpr std::uint64_t kEnable_ticks = static_cast<std::uint64_t>(kEnable_s * kControlHz);
/// A drive that does not say whether it is enabled is taken to be after this many replies.
constexpr std::uint64_t kRepliesToEnable = 3;
/// A drive that did not answer this many requests for this long may have been without its supply.
/// The first alone excludes a stall of this program.
constexpr std::uint64_t kRebootRequests = 10, kReboot_ticks = kControlHz / 20;
/// A request is lost if it was not answered for one to two of these. Adapters that hold frames back
/// for less deliver no surplus.
constexpr std::uint64_t kForget_ticks = kControlHz / 10;

}  // namespace

Drive::Drive(const DriveConfig& config, const HardwareConfig& hardware) noexcept
    : config_(config),
      terms_{.torque_only = hardware.mode == DriveMode::kTorque,
             .max_torque_nm = config.max_torque_nm,
             .timeout_s = hardware.drive_timeout_s},
      temperature_limit_degc_(hardware.temperature_limit_degc),
      voltage_low_v_(hardware.voltage_low_v),
      voltage_high_v_(hardware.voltage_high_v) {}

void Drive::off_frame(CanFrame& frame) noexcept {
  // A locked drive stays off until its fault is cleared: every other frame does.
  cleared_ = state_.locked && !cleared_;
  std::visit([&](const auto& drive) { encode_off(drive, cleared_, frame); }, config_.drive);
}

void Drive::command_frame(const SetPoint& joint, CanFrame& frame) const noexcept {
  const double turn = config_.sign * config_.gear;  // of the drive for one of the joint
  const double gear2 = config_.gear * config_.gear;
  const SetPoint command{.position_rad = turn * (joint.position_rad - config_.zero_rad),
                         .velocity_radps = turn * joint.velocity_radps,
                         .kp_nmprad = joint.kp_nmprad / gear2,
                         .kd_nmsprad = joint.kd_nmsprad / gear2,
                         .torque_nm = joint.torque_nm / turn};
  std::visit([&](const auto& drive) { encode_command(drive, command, terms_, frame); },
             config_.drive);
}

bool Drive::next_frame(const SetPoint* set_point, std::uint64_t tick, CanFrame& frame) noexcept {
  if (set_point == nullptr || has(DriveTrouble::kForgotTimeout)) {
    if (phase_ != Phase::kOff) replies_off_ = 0;
    phase_ = Phase::kOff;
    set(DriveTrouble::kNotEnabled, false);
    set(DriveTrouble::kSwitchedOff, false);
    set(DriveTrouble::kBusOff, false);
    off_frame(frame);
  } else if (phase_ == Phase::kLost) {
    if (unanswered_++ == 0) asked_tick_ = tick;  // its supply may be gone as well
    return false;
  } else if (phase_ == Phase::kOn) {
    if (!has(DriveTrouble::kSwitchedOff)) {
      command_frame(*set_point, frame);
    } else if (state_.damps) {
      // As it should until all are off; told to be off it would be limp.
      std::visit([&](const auto& drive) { encode_probe(drive, frame); }, config_.drive);
    } else {
      off_frame(frame);
    }
  } else {
    if (phase_ == Phase::kOff) {
      phase_ = Phase::kEnabling;
      enabling_since_ = tick;
      replies_at_enable_ = replies_;
    }
    if (tick - enabling_since_ > kEnable_ticks) set(DriveTrouble::kNotEnabled, true);
    std::visit([&](const auto& drive) { encode_enable(drive, terms_, frame); }, config_.drive);
  }
  ++sent_;
  expect_reply(tick);
  if (unanswered_++ == 0) asked_tick_ = tick;
  return true;
}

bool Drive::is_command(const CanFrame& frame) const noexcept {
  return std::visit([&](const auto& drive) { return is_command_to(drive, frame); }, config_.drive);
}

void Drive::note_foreign_command(std::uint64_t tick) noexcept {
  ++foreign_commands_;
  foreign_until_ = tick + kForeign_ticks;
}

void Drive::expect_reply(std::uint64_t tick) noexcept {
  if (tick >= open_since_ + kForget_ticks) {
    open_old_ = tick < open_since_ + 2 * kForget_ticks ? open_new_ : 0;
    open_new_ = 0;
    open_since_ = tick;
  }
  ++open_new_;
}

void Drive::judge_surplus(std::uint64_t tick) noexcept {
  // The newest first: what was lost is then forgotten with its time.
  if (open_new_ > 0) {
    --open_new_;
  } else if (open_old_ > 0) {
    --open_old_;
  } else {
    // One alone may be a frame that the bus delivered twice.
    if (surplus_++ > 0 && tick <= surplus_tick_ + kSurplus_ticks) {
      foreign_until_ = tick + kForeign_ticks;
    }
    surplus_tick_ = tick;
  }
}

bool Drive::take(const CanFrame& frame, std::uint64_t tick) noexcept {
  const bool was_silent = unanswered_ > kRebootRequests && tick > asked_tick_ + kReboot_ticks;
  const ReplyKind kind = std::visit(
      [&](const auto& drive) { return decode_state(drive, frame, state_); }, config_.drive);
  if (kind == ReplyKind::kBad) ++bad_;
  if (kind != ReplyKind::kState) return false;
  const double turn = config_.sign * config_.gear;
  position_rad_ = state_.position_rad / turn + config_.zero_rad;
  velocity_radps_ = state_.velocity_radps / turn;
  torque_nm_ = state_.torque_nm * turn / config_.reported_torque;
  ++replies_;
  judge_power(was_silent);
  judge_surplus(tick);
  unanswered_ = 0;
  tick_ = tick;
  judge_supply();
  return true;
}

void Drive::judge_power(bool was_silent) noexcept {
  const bool known = state_.power != DrivePower::kUnknown;
  const bool enabled = state_.power == DrivePower::kOn;
  // Off without a reason of its own: it has just started, or another program switched it off. What
  // was cleared after a fault says so too, but not in its first answer.
  const bool plainly_off = known && !enabled && state_.fault == 0;
  const bool at_once = phase_ == Phase::kOn && !has(DriveTrouble::kSwitchedOff);
  const bool forgets =
      std::visit([](const auto& drive) { return forgets_timeout(drive); }, config_.drive);
  if (forgets && plainly_off && (was_silent || at_once)) set(DriveTrouble::kForgotTimeout, true);
  if (phase_ == Phase::kEnabling) {
    if (known ? enabled : replies_ >= replies_at_enable_ + kRepliesToEnable) phase_ = Phase::kOn;
  } else if (phase_ == Phase::kOff) {
    if (!known || !enabled) ++replies_off_;
  } else if (phase_ == Phase::kOn && known) {
    // Answers come in their order: since one has said "enabled", none of before is on its way.
    if (enabled) return;
    set(DriveTrouble::kSwitchedOff, true);
  }
}

void Drive::judge_supply() noexcept {
  // What a drive does not say (NaN) is neither.
  const double hot_degc = state_.temperature_degc - temperature_limit_degc_, v = state_.voltage_v;
  const auto outside = [&](double share) {
    return v < (1.0 - share) * voltage_low_v_ || v > (1.0 + share) * voltage_high_v_;
  };
  set(DriveTrouble::kOverTemperature, hot_degc > kTooHot_degc);
  set(DriveTrouble::kVoltage, outside(kVoltageShare));
  warning_ = (hot_degc > 0.0 ? static_cast<std::uint64_t>(DriveTrouble::kOverTemperature) : 0) |
             (outside(0.0) ? static_cast<std::uint64_t>(DriveTrouble::kVoltage) : 0);
  if (warning_ != 0) last_warning_ = warning_;
}

void Drive::lose_bus() noexcept {
  if (phase_ == Phase::kOff) return;
  phase_ = Phase::kLost;
  set(DriveTrouble::kBusOff, true);
}

void Drive::set(DriveTrouble trouble, bool on) noexcept {
  const auto bit = static_cast<std::uint64_t>(trouble);
  trouble_ = on ? trouble_ | bit : trouble_ & ~bit;
  if (fault() != 0) last_fault_ = fault();
}

std::string drive_fault_words(const DriveConfig& config, std::uint64_t fault) {
  std::string words;
  const auto add = [&](const std::string& what) { words += (words.empty() ? "" : ", ") + what; };
  const auto code = static_cast<std::uint8_t>(fault & 0xFF);
  if (code != 0) {
    add(std::visit([&](const auto& drive) { return std::string(fault_words(drive, code)); },
                   config.drive));
  }
  const auto trouble = [&](DriveTrouble t, const char* what) {
    if ((fault & static_cast<std::uint64_t>(t)) != 0) add(what);
  };
  trouble(DriveTrouble::kNotEnabled, "does not let itself be enabled");
  trouble(DriveTrouble::kSwitchedOff, "switched off by itself");
  trouble(DriveTrouble::kOverTemperature, "too hot");
  trouble(DriveTrouble::kVoltage, "supply voltage out of range");
  trouble(DriveTrouble::kBusOff, "its bus was off");
  trouble(DriveTrouble::kForgotTimeout,
          "was without its supply, or silent for as long: it has no time-out now, start the "
          "program again");
  return words;
}

}  // namespace sandrunner
