// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/emulated/emulated_drive.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "rt/core/joint_pd.h"

namespace sandrunner::hil {

EmulatedDrive::EmulatedDrive(const DriveConfig& config, double timeout_s)
    : sign_(config.sign),
      gear_(config.gear),
      zero_rad_(config.zero_rad),
      family_(std::visit(
          [&](const auto& drive) { return decltype(family_)(emulate(drive, timeout_s)); },
          config.drive)) {
  core_.max_torque_nm = config.max_torque_nm;
}

void EmulatedDrive::measure(double joint_rad, double joint_radps) noexcept {
  core_.position_rad = turn() * (joint_rad - zero_rad_);
  core_.velocity_radps = turn() * joint_radps;
}

bool EmulatedDrive::answer(const CanFrame& request, double now_s, CanFrame& reply) noexcept {
  if (core_.faults.silent || request.error) return false;
  core_.look_at_clock(now_s);
  return std::visit([&](auto& drive) { return drive.answer(core_, request, now_s, reply); },
                    family_);
}

double EmulatedDrive::torque_nm(double now_s) noexcept {
  core_.look_at_clock(now_s);
  core_.torque_nm = 0.0;
  if (core_.state == State::kOn) {
    const SetPoint& c = core_.commanded;
    const bool moves_on = std::visit([](const auto& drive) { return drive.kMovesOn; }, family_);
    const double moved_rad =
        moves_on ? c.velocity_radps * std::max(now_s - core_.commanded_s, 0.0) : 0.0;
    const double torque_nm =
        joint_torque(core_.measured_rad(), core_.velocity_radps, c.position_rad + moved_rad,
                     c.velocity_radps, c.kp_nmprad, c.kd_nmsprad, c.torque_nm);
    core_.torque_nm = clamp_to(torque_nm, -core_.commanded_most_nm, core_.commanded_most_nm);
  } else if (core_.state == State::kTimedOut) {
    const TimedOut law = timed_out();
    core_.torque_nm =
        clamp_to(-law.kd_nmsprad * core_.velocity_radps, -law.max_torque_nm, law.max_torque_nm);
  }
  return core_.torque_nm * turn() * (core_.faults.reversed ? -1.0 : 1.0);
}

TimedOut EmulatedDrive::timed_out() const noexcept {
  return std::visit([](const auto& drive) { return drive.timed_out(); }, family_);
}

void EmulatedDrive::reboot() noexcept {
  core_.state = State::kOff;
  std::visit([](auto& drive) { drive.reboot(); }, family_);
}

void EmulatedDrive::scale_ranges(double factor) noexcept {
  std::visit([&](auto& drive) { drive.scale_ranges(factor); }, family_);
}

void EmulatedDrive::swap_ids(EmulatedDrive& other) noexcept {
  std::visit(
      [](auto& drive, auto& with) {
        // Families do not hear each other.
        if constexpr (std::is_same_v<decltype(drive), decltype(with)>) drive.swap_ids(with);
      },
      family_, other.family_);
}

bool EmulatedDrive::passive() const noexcept {
  return core_.state != State::kOn ||
         (core_.commanded.kp_nmprad == 0.0 && std::fabs(core_.commanded.torque_nm) < 0.1);
}

bool EmulatedDrive::limp() const noexcept {
  return core_.state == State::kOff || core_.state == State::kFault ||
         (core_.state == State::kTimedOut && timed_out().kd_nmsprad == 0.0);
}

double EmulatedDrive::kp_nmprad() const noexcept {
  return core_.state == State::kOn ? core_.commanded.kp_nmprad * gear_ * gear_ : 0.0;
}

double EmulatedDrive::kd_nmsprad() const noexcept {
  return core_.state == State::kOn ? core_.commanded.kd_nmsprad * gear_ * gear_ : 0.0;
}

}  // namespace sandrunner::hil
