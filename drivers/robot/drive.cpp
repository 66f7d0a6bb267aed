// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/robot/drive.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "drivers/drives/mit/damiao_registers.h"

namespace sandrunner {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint64_t kEnable_ticks = static_cast<std::uint64_t>(kEnable_s * kControlHz);
/// A drive that does not say whether it is enabled is taken to be after so many replies.
constexpr std::uint64_t kRepliesToEnable = 3;
/// A Damiao that did not answer so many requests for so long may have been without its supply. Of a
/// stall of this program alone it is not told by the first.
constexpr std::uint64_t kRebootRequests = 10, kReboot_ticks = kControlHz / 20;
/// A request is lost if it was not answered for one to two of these. Adapters that hold frames back
/// for less deliver no surplus.
constexpr std::uint64_t kForget_ticks = kControlHz / 10;

/// MIT codes have none for zero: a drive at rest says half a step. Left as it is, a joint that
/// stands would seem to creep for ever.
double without_half_step(double velocity_radps, double limit_radps) noexcept {
  const double step_radps = 2.0 * limit_radps / 4095.0;
  return std::fabs(velocity_radps) < 0.51 * step_radps ? 0.0 : velocity_radps;
}

}  // namespace

Drive::Drive(const DriveConfig& config, const HardwareConfig& hardware) noexcept
    : config_(config),
      torque_only_(hardware.mode == DriveMode::kTorque),
      temperature_limit_degc_(hardware.temperature_limit_degc),
      voltage_low_v_(hardware.voltage_low_v),
      voltage_high_v_(hardware.voltage_high_v),
      timeout_s_(hardware.drive_timeout_s),
      temperature_degc_(kUnknown),
      voltage_v_(kUnknown) {}

void Drive::off_frame(CanFrame& frame) noexcept {
  if (config_.protocol == Protocol::kMit) {
    // A Damiao that has timed out stays so until that is cleared: every other frame does.
    cleared_ = is_damiao() && maker_fault_ == kDamiaoLostHost && !cleared_;
    encode_mit_special(config_.mit, cleared_ ? MitSpecial::kClearFault : MitSpecial::kDisable,
                       frame);
  } else {
    encode_moteus_stop(config_.moteus, kMoteusState, frame);
  }
}

void Drive::enable_frame(CanFrame& frame) const noexcept {
  if (config_.protocol == Protocol::kMit) {
    encode_mit_special(config_.mit, MitSpecial::kEnable, frame);
  } else {
    command_frame({}, frame);  // a moteus is enabled by its first command: here one of no torque
  }
}

void Drive::command_frame(const JointSetPoint& joint, CanFrame& frame) const noexcept {
  const double turn = config_.sign * config_.gear;  // of the drive for one of the joint
  const double gear2 = config_.gear * config_.gear;
  if (config_.protocol == Protocol::kMit) {
    encode_mit_command(config_.mit,
                       {.position_rad = turn * (joint.position_rad - config_.zero_rad),
                        .velocity_radps = turn * joint.velocity_radps,
                        .kp_nmprad = joint.kp_nmprad / gear2,
                        .kd_nmsprad = joint.kd_nmsprad / gear2,
                        .torque_nm = joint.torque_nm / turn},
                       frame);
  } else if (torque_only_) {
    encode_moteus_torque(config_.moteus, joint.torque_nm / turn, timeout_s_, kMoteusState, frame);
  } else {
    encode_moteus_position(config_.moteus,
                           {.position_rad = turn * (joint.position_rad - config_.zero_rad),
                            .velocity_radps = turn * joint.velocity_radps,
                            .kp_nmprad = joint.kp_nmprad / gear2,
                            .kd_nmsprad = joint.kd_nmsprad / gear2,
                            .torque_nm = joint.torque_nm / turn,
                            .max_torque_nm = config_.max_torque_nm,
                            .watchdog_s = timeout_s_},
                           kMoteusState, frame);
  }
}

bool Drive::next_frame(const JointSetPoint* set_point, std::uint64_t tick,
                       CanFrame& frame) noexcept {
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
    } else if (timed_out_) {
      // It damps by itself, as it should until all are off; told to be off it would be limp.
      encode_moteus_query(config_.moteus, kMoteusState, frame);
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
    enable_frame(frame);
  }
  ++sent_;
  expect_reply(tick);
  if (unanswered_++ == 0) asked_tick_ = tick;
  return true;
}

bool Drive::is_command(const CanFrame& frame) const noexcept {
  if (frame.error) return false;
  if (config_.protocol == Protocol::kMoteus) {
    MoteusRequest request;
    return decode_moteus_request(config_.moteus, frame, request) == MoteusStatus::kOk;
  }
  DamiaoAccess access;
  return (!frame.extended && frame.id == config_.mit.motor_id) ||
         decode_damiao_request(config_.mit, frame, access) == DamiaoStatus::kOk;
}

void Drive::hear_command(std::uint64_t tick) noexcept {
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
  const bool taken =
      config_.protocol == Protocol::kMit ? take_mit(frame, was_silent) : take_moteus(frame);
  if (!taken) return false;
  judge_surplus(tick);
  unanswered_ = 0;
  tick_ = tick;
  judge_supply();
  return true;
}

bool Drive::take_mit(const CanFrame& frame, bool was_silent) noexcept {
  MitReply reply;
  const MitStatus status = decode_mit_reply(config_.mit, frame, reply);
  if (status != MitStatus::kOk && status != MitStatus::kUnknownState) {
    if (status == MitStatus::kWrongLength) ++bad_;
    return false;
  }
  const double turn = config_.sign * config_.gear;
  position_rad_ = reply.position_rad / turn + config_.zero_rad;
  velocity_radps_ =
      without_half_step(reply.velocity_radps, config_.mit.limits.velocity_radps) / turn;
  torque_nm_ = reply.torque_nm * turn;
  temperature_degc_ = std::fmax(reply.temperature_degc, reply.rotor_temperature_degc);
  voltage_v_ = reply.bus_voltage_v;
  maker_fault_ = reply.fault;
  if (status == MitStatus::kUnknownState) maker_fault_ = 0xFF;
  ++replies_;
  judge_power(reply.power != MitPower::kUnknown, reply.power == MitPower::kEnabled, was_silent);
  return true;
}

bool Drive::take_moteus(const CanFrame& frame) noexcept {
  MoteusReply reply;
  const MoteusStatus status = decode_moteus_reply(config_.moteus, frame, reply);
  if (status != MoteusStatus::kOk) {
    if (status != MoteusStatus::kOtherId && status != MoteusStatus::kErrorFrame) ++bad_;
    return false;
  }
  const double turn = config_.sign * config_.gear;
  position_rad_ = reply.position_rad / turn + config_.zero_rad;
  velocity_radps_ = reply.velocity_radps / turn;
  torque_nm_ = reply.torque_nm * turn;
  temperature_degc_ = std::fmax(reply.temperature_degc, reply.motor_temperature_degc);
  voltage_v_ = reply.voltage_v;
  maker_fault_ = reply.mode == MoteusMode::kFault ? reply.code : 0;
  timed_out_ = reply.mode == MoteusMode::kTimeout;
  ++replies_;
  judge_power(true, reply.mode == MoteusMode::kPosition || reply.mode == MoteusMode::kEnabling,
              false);
  return true;
}

void Drive::judge_power(bool known, bool enabled, bool was_silent) noexcept {
  // Off without a reason of its own: it has just started, or somebody else switched it off. What
  // was cleared after a fault says so too, but not in its first answer.
  const bool plainly_off = known && !enabled && maker_fault_ == 0;
  const bool at_once = phase_ == Phase::kOn && !has(DriveTrouble::kSwitchedOff);
  if (is_damiao() && plainly_off && (was_silent || at_once)) {
    set(DriveTrouble::kForgotTimeout, true);
  }
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
  set(DriveTrouble::kHot, temperature_degc_ > temperature_limit_degc_);
  set(DriveTrouble::kVoltage, voltage_v_ < voltage_low_v_ || voltage_v_ > voltage_high_v_);
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
    add(config.protocol == Protocol::kMit ? mit_fault_words(config.mit.variant, code)
                                          : moteus_fault_words(code));
  }
  const auto trouble = [&](DriveTrouble t, const char* what) {
    if ((fault & static_cast<std::uint64_t>(t)) != 0) add(what);
  };
  trouble(DriveTrouble::kNotEnabled, "does not let itself be enabled");
  trouble(DriveTrouble::kSwitchedOff, "switched off by itself");
  trouble(DriveTrouble::kHot, "too hot");
  trouble(DriveTrouble::kVoltage, "supply voltage out of range");
  trouble(DriveTrouble::kBusOff, "its bus was off");
  trouble(DriveTrouble::kForgotTimeout,
          "was without its supply, or silent for as long: it has no time-out now, start the "
          "program again");
  return words;
}

}  // namespace sandrunner
