// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/emulated/emulated_moteus.h"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace sandrunner::hil {
namespace {

using State = DriveCore::State;

constexpr double kTurn_rad = 2.0 * std::numbers::pi;
/// Settings of moteus' firmware as it ships: servo.default_timeout_s, servo.timeout_max_torque_Nm.
constexpr double kDefaultTimeout_s = 0.1, kTimeoutTorque_nm = 5.0;

}  // namespace

bool EmulatedMoteus::answer(DriveCore& core, const CanFrame& request, double now_s,
                            CanFrame& reply) noexcept {
  MoteusRequest wanted;
  if (decode_moteus_request(drive_, request, wanted) != MoteusStatus::kOk) return false;
  ++core.frames;
  // A command is in force from the next turn of the drive's own loop on, after the answer.
  const State answered = core.state;
  obey(core, wanted, now_s);
  constexpr std::array kModes = {MoteusMode::kStopped, MoteusMode::kPosition, MoteusMode::kTimeout,
                                 MoteusMode::kFault};
  const MoteusReply state{.mode = core.faults.code != 0
                                      ? MoteusMode::kFault
                                      : kModes[static_cast<std::size_t>(answered)],
                          .position_rad = core.measured_rad(),
                          .velocity_radps = core.velocity_radps,
                          .torque_nm = core.torque_nm,
                          .voltage_v = DriveCore::kSupply_v,
                          .temperature_degc = core.faults.temperature_degc,
                          .motor_temperature_degc = core.faults.temperature_degc,
                          .watchdog_s = core.timeout_s,
                          .code = core.faults.code};
  if (wanted.num_reads == 0 || !wanted.address.wants_reply) return false;
  return encode_moteus_reply(drive_, wanted, state, reply) == MoteusStatus::kOk && core.deliver();
}

void EmulatedMoteus::obey(DriveCore& core, const MoteusRequest& wanted,
                          double now_s) const noexcept {
  if (!wanted.has_mode) return;
  if (wanted.mode != MoteusMode::kPosition) {
    core.state = State::kOff;  // every other mode is taken for a stop
  } else if (core.state == State::kOff || core.state == State::kOn) {
    const double kp = wanted.kp_scale * drive_.kp_nmprev / kTurn_rad;
    const double kd = wanted.kd_scale * drive_.kd_nmsprev / kTurn_rad;
    const bool placed = !std::isnan(wanted.position_rad);
    const double most_nm =
        std::isnan(wanted.max_torque_nm) ? core.max_torque_nm : wanted.max_torque_nm;
    const double timeout_s = wanted.watchdog_s == 0.0        ? kDefaultTimeout_s
                             : std::isnan(wanted.watchdog_s) ? 0.0
                                                             : wanted.watchdog_s;
    core.command({placed ? wanted.position_rad : 0.0, wanted.velocity_radps, placed ? kp : 0.0, kd,
                  wanted.torque_nm},
                 most_nm, timeout_s, now_s);
    core.look_at_clock(now_s);
  }
}

TimedOut EmulatedMoteus::timed_out() const noexcept {
  return {.kd_nmsprad = drive_.kd_nmsprev / kTurn_rad, .max_torque_nm = kTimeoutTorque_nm};
}

void EmulatedMoteus::swap_ids(EmulatedMoteus& other) noexcept {
  std::swap(drive_.id, other.drive_.id);
}

}  // namespace sandrunner::hil
