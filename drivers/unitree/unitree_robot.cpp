// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/unitree/unitree_robot.h"

#include <algorithm>
#include <ctime>
#include <utility>

#include "rt/base/clock_ns.h"
#include "rt/core/warnings.h"

namespace sandrunner {
namespace {

// A command takes one message to the robot, and a state one back; a motor needs its time.
constexpr std::uint64_t kModeFollows_ticks = kControlHz / 10;
constexpr std::uint64_t kRemoteLost_ticks = kControlHz / 5;
constexpr std::uint64_t kStatesStopped_ticks = 16;  // two were not there

}  // namespace

std::string unitree_fault_words(std::uint64_t faults) {
  std::string words;
  const auto add = [&](UnitreeFault fault, const char* text) {
    if ((faults & static_cast<std::uint64_t>(fault)) == 0) return;
    words += (words.empty() ? "" : ", ") + std::string(text);
  };
  add(UnitreeFault::kMode, "another mode than commanded");
  add(UnitreeFault::kTooHot, "too hot");
  add(UnitreeFault::kBattery, "battery low");
  return words;
}

UnitreeRobot::UnitreeRobot(const UnitreeConfig& config, std::unique_ptr<unitree::WireProcess> wire)
    : config_(config), wire_(std::move(wire)), memory_(wire_->memory()) {}

std::uint64_t UnitreeRobot::faults_of(int j) const noexcept {
  const bool follows =
      enabled_ticks_ <= kModeFollows_ticks || newest_.state.mode[j] == config_.motor_mode;
  return beyond(j, kTooHot_degc, kBatteryShare) |
         (follows ? 0 : static_cast<std::uint64_t>(UnitreeFault::kMode));
}

std::uint64_t UnitreeRobot::warnings_of(int j) const noexcept { return beyond(j, 0.0, 1.0); }

std::uint64_t UnitreeRobot::beyond(int j, double margin_degc, double share) const noexcept {
  const unitree::RobotState& state = newest_.state;
  const bool hot = state.temperature_degc[j] > config_.temperature_limit_degc + margin_degc;
  const bool low = state.battery_percent < share * config_.low_battery_percent;
  return (hot ? static_cast<std::uint64_t>(UnitreeFault::kTooHot) : 0) |
         (low ? static_cast<std::uint64_t>(UnitreeFault::kBattery) : 0);
}

void UnitreeRobot::take_state(std::uint64_t tick, SensorFrame& frame) noexcept {
  const unitree::WireReport& report = memory_.report.read();
  if (started_ && report.counters.taken == newest_.counters.taken) {
    newest_.counters = report.counters;
    return;
  }
  const std::int64_t age_ns =
      std::max<std::int64_t>(clock_ns(CLOCK_MONOTONIC) - report.sampled_ns, 0);
  const auto ago = static_cast<std::uint64_t>(age_ns / kControlPeriod_ns);
  state_tick_ = tick - std::min(ago, tick);
  const unitree::RobotState& state = report.state;
  for (int j = 0; j < kNumJoints; ++j) {
    // Where the robot's own bus lost a message, these are the values of the one before.
    if (started_ && state.lost[j] != newest_.state.lost[j]) continue;
    frame.joints.position_rad[j] = state.position_rad[j];
    frame.joints.velocity_radps[j] = state.velocity_radps[j];
    frame.joints.torque_nm[j] = state.torque_nm[j];
    frame.joints.tick[j] = state_tick_;
  }
  frame.imu = {.orientation_wxyz = state.orientation_wxyz,
               .angular_velocity_radps = state.angular_velocity_radps,
               .linear_acceleration_mps2 = state.linear_acceleration_mps2,
               .tick = state_tick_};
  if (!started_) lost_at_start_ = state.lost;
  if (state.remote.on || !started_) remote_tick_ = tick;
  newest_ = report;
  started_ = true;
}

void UnitreeRobot::read(std::uint64_t tick, SensorFrame& frame) noexcept {
  tick_ = tick;
  take_state(tick, frame);
  for (int j = 0; j < kNumJoints; ++j) {
    frame.joints.drive_fault[j] = faults_of(j);
    frame.joints.drive_warning[j] = warnings_of(j);
    all_faults_[j] |= frame.joints.drive_fault[j] | frame.joints.drive_warning[j];
  }
  const bool remote_lost =
      config_.need_remote && !newest_.state.remote.on && tick - remote_tick_ > kRemoteLost_ticks;
  frame.emergency_stop = newest_.state.remote.stop || remote_lost ? 1 : 0;
  const bool foreign = memory_.foreign.load(std::memory_order_relaxed);
  frame.foreign_traffic = foreign ? kAllJoints : 0;
  // A wire that follows no more because of another program has named that.
  const bool cut = memory_.cut.load(std::memory_order_relaxed) ||
                   (!foreign && memory_.gave_up.load(std::memory_order_relaxed));
  frame.drives_cut = cut ? 1 : 0;
}

void UnitreeRobot::write(const SafeCommand& command) noexcept {
  enabled_ticks_ = command.enabled() ? enabled_ticks_ + 1 : 0;
  // A joint whose values are not trusted gets no torque while states come: its encoder may be
  // wrong. Once none come, or where no joint is trusted, it is the network, and the motors, which
  // damp by their own encoders, may still hear.
  const bool states_come = tick_ - state_tick_ <= kStatesStopped_ticks;
  const bool encoder = states_come && command.blind_joints() != kAllJoints;
  memory_.command.write({.joints = command.joints(),
                         .enabled = command.enabled() ? std::uint64_t{1} : 0,
                         .blind_joints = encoder ? command.blind_joints() : 0,
                         .written_ns = clock_ns(CLOCK_MONOTONIC)});
}

void UnitreeRobot::cut_drives() noexcept { memory_.cut.store(true); }

void UnitreeRobot::shut_down() noexcept {
  memory_.ended.store(true);
  for (int i = 0; i < 100; ++i) {
    if (memory_.phase.load() == unitree::WirePhase::kEnded) return;
    const timespec pause{.tv_sec = 0, .tv_nsec = 2'000'000};
    nanosleep(&pause, nullptr);
  }
}

}  // namespace sandrunner
