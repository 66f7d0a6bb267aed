// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/unitree_link.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "rt/base/clock_ns.h"
#include "rt/core/split_mix.h"
#include "rt/realtime/clock.h"
#include "sim/step/actuator.h"

namespace sandrunner::hil {
namespace {

constexpr std::int64_t kCycle_ns = 2'000'000;
constexpr int kTicksPerCycle = kControlHz / 500;
constexpr double kFirmwareTimeout_s = 0.1, kFirmwareDamping_nmsprad = 3.0;
constexpr double kHealthyBattery_percent = 80, kHealthy_degc = 35;
constexpr double kSupply_v = 29.0;

}  // namespace

UnitreeLink::UnitreeLink(const UnitreeConfig& config, const sim::Robot& robot,
                         const sim::SimulatorConfig& simulator, std::span<const TimedFault> script)
    : config_(config),
      torque_limit_nm_(robot.model.torque_limit_nm),
      line_(sim::drive_line<double>(simulator.torque_speed_line)),
      peer_(config_, std::ranges::find(script, std::string("wrong-type"), &TimedFault::kind) !=
                         script.end()) {
  state_.temperature_degc.fill(static_cast<std::int8_t>(kHealthy_degc));
  state_.battery_percent = static_cast<std::uint8_t>(kHealthyBattery_percent);
  state_.supply_v = kSupply_v;
  state_.remote.on = true;
}

std::string UnitreeLink::greeting() const {
  return fmt::format("the robot is there, in domain {} on {}; Ctrl-C ends it", config_.domain,
                     config_.interface);
}

std::int64_t UnitreeLink::cycle_ns() const noexcept { return kCycle_ns; }

double UnitreeLink::exchange(std::int64_t end_ns) {
  while (!queue_.empty() && queue_.front().due_ns < end_ns) {
    sleep_until(queue_.front().due_ns);
    send_due(clock_ns(CLOCK_MONOTONIC));
  }
  sleep_until(end_ns);
  now_ns_ = clock_ns(CLOCK_MONOTONIC);
  peer_.serve();
  peer_.take_commands([&](const unitree::LowCmd& command) { follow(command); });
  if (damps_ && silent_s() > kFirmwareTimeout_s) damp_by_itself();
  return now_s();
}

void UnitreeLink::follow(const unitree::LowCmd& command) {
  ++commands_;
  if (const char* const mistake =
          unitree::command_mistake(command, static_cast<std::uint8_t>(config_.motor_mode))) {
    if (refused_++ == 0) refusal_ = mistake;
    return;
  }
  const bool was_on = drives_[0].on;
  for (int j = 0; j < kNumJoints; ++j) {
    const auto& motor = command.motor_cmd[unitree::motor_of(j)];
    Drive& drive = drives_[j];
    drive = {motor.q, motor.dq, motor.tau, motor.kp, motor.kd, motor.mode != unitree::kMotorOff};
    if (!drive.on) drive = {};
    if (drive.q_rad >= 0.9 * unitree::kFreePosition) drive.kp = drive.q_rad = 0.0;
    if (drive.dq_radps >= 0.9 * unitree::kFreeVelocity) drive.kd = drive.dq_radps = 0.0;
  }
  if (was_on && drives_[0].on) longest_gap_s_ = std::max(longest_gap_s_, silent_s());
  commanded_s_ = now_s();
}

void UnitreeLink::damp_by_itself() {
  for (Drive& drive : drives_) {
    if (drive.on) drive = {.kd = kFirmwareDamping_nmsprad, .on = true};
  }
}

std::span<const LinkFault<UnitreeLink>> UnitreeLink::faults() {
  using F = const TimedFault&;
  static constexpr auto kFaults = std::to_array<LinkFault<UnitreeLink>>({
      {{"gap", Takes::kNumber, "MS: no states for this long"},
       [](UnitreeLink& l, F f) { l.gap_until_s_ = l.fault_s_ + 1e-3 * f.value; }},
      {{"burst", Takes::kNumber, "MS: states are held up for this long, then come at once"},
       [](UnitreeLink& l, F f) { l.held_until_s_ = l.fault_s_ + 1e-3 * f.value; }},
      {{"jitter", Takes::kNumber, "MS: each state is late by up to this, by chance"},
       [](UnitreeLink& l, F f) { l.jitter_s_ = 1e-3 * f.value; }},
      {{"late", Takes::kNumber, "MS: each state is late by this"},
       [](UnitreeLink& l, F f) { l.late_s_ = 1e-3 * f.value; }},
      {{"loses", Takes::kNumber, "N: one of N states is lost"},
       [](UnitreeLink& l, F f) { l.loses_ = static_cast<int>(f.value); }},
      {{"silent", Takes::kNothing, "no states any more"},
       [](UnitreeLink& l, F) { l.silent_ = true; }},
      {{"bad-crc", Takes::kNothing, "states with a wrong CRC"},
       [](UnitreeLink& l, F) { l.bad_crc_ = true; }},
      {{"no-crc", Takes::kNothing, "states without a CRC"},
       [](UnitreeLink& l, F) { l.no_crc_ = true; }},
      {{"nan", Takes::kJoint, "JOINT: its position is not a number"},
       [](UnitreeLink& l, F f) { l.nan_joint_ = f.first; }},
      {{"stuck", Takes::kNothing, "the clock in the states stands still"},
       [](UnitreeLink& l, F) { l.stuck_ = true; }},
      {{"backwards", Takes::kNothing, "the clock in the states goes back by 1 s"},
       [](UnitreeLink& l, F) { l.back_ms_ = 1000; }},
      {{"lost", Takes::kJoint, "JOINT: the robot's own bus hears no more of its motor"},
       [](UnitreeLink& l, F f) { l.lost_joint_ = f.first; }},
      {{"hot", Takes::kJointAndNumber, "JOINT DEGC: temperature of its motor"},
       [](UnitreeLink& l, F f) {
         l.state_.temperature_degc[f.first] = static_cast<std::int8_t>(f.value);
       }},
      {{"mode", Takes::kJointAndNumber, "JOINT N: mode that its motor reports"},
       [](UnitreeLink& l, F f) { l.mode_[f.first] = static_cast<int>(f.value); }},
      {{"battery", Takes::kNumber, "PERCENT: what the battery has"},
       [](UnitreeLink& l, F f) { l.state_.battery_percent = static_cast<std::uint8_t>(f.value); }},
      {{"foreign", Takes::kNumber, "N: another program sends N commands, at 500 Hz"},
       [](UnitreeLink& l, F f) { l.foreign_left_ = static_cast<int>(f.value); }},
      {{"sport", Takes::kNothing, "sport mode is on again, and commands the robot"},
       [](UnitreeLink& l, F) {
         l.sport_ = true;
         l.peer_.mode = "mcf";
       }},
      {{"remote-stop", Takes::kNothing, "L2 and B of the remote are pressed"},
       [](UnitreeLink& l, F) { l.state_.remote.stop = true; }},
      {{"remote-lost", Takes::kNothing, "the remote is switched off"},
       [](UnitreeLink& l, F) { l.state_.remote.on = false; }},
      {{"wrong-type", Takes::kNothing, "states are of another type (at `start`)"},
       [](UnitreeLink&, F) {}},
      {{"firmware-damps", Takes::kNothing,
        "without commands for 100 ms the robot damps; else it holds the last one"},
       [](UnitreeLink& l, F) { l.damps_ = true; }},
  });
  return kFaults;
}

bool UnitreeLink::make(const TimedFault& fault, double now_s) {
  fault_s_ = now_s;
  return make_fault(faults(), *this, fault);
}

const JointArray<DriveMoment>& UnitreeLink::step(double now_s, sim::Simulator& robot) {
  JointArray<double> torque_nm;
  for (int tick = 0; tick < kTicksPerCycle; ++tick) {
    const sim::RigidState<double>& x = robot.state().robot.rigid;
    for (int j = 0; j < kNumJoints; ++j) {
      const Drive& d = drives_[j];
      torque_nm[j] = sim::drive_torque<double>(
          j, x.q[j], x.qd[j],
          {.q = d.q_rad, .qd = d.dq_radps, .kp = d.kp, .kd = d.kd, .feedforward_nm = d.tau_nm},
          torque_limit_nm_[j], line_);
    }
    robot.step(torque_nm);
  }
  for (int j = 0; j < kNumJoints; ++j) {
    const Drive& d = drives_[j];
    const bool passive = d.kp == 0.0 && d.tau_nm == 0.0;
    moments_[j] = {.on = d.on,
                   .off = !d.on,
                   .passive = passive,
                   .limp = passive && d.kd == 0.0,
                   .kp_nmprad = d.kp,
                   .torque_nm = torque_nm[j]};
  }
  send_foreign();
  send_state(robot, now_s);
  ++cycle_;
  return moments_;
}

void UnitreeLink::send_foreign() {
  if (foreign_left_ == 0 && !sport_) return;
  unitree::LowCmd foreign;
  unitree::encode_damping(static_cast<std::uint8_t>(config_.motor_mode), {9.0, 9.0, 9.0}, foreign);
  peer_.send_foreign(foreign);
  if (foreign_left_ > 0) --foreign_left_;
}

void UnitreeLink::send_state(const sim::Simulator& robot, double now_s) {
  const sim::RigidState<double>& x = robot.state().robot.rigid;
  for (int j = 0; j < kNumJoints; ++j) {
    if (j == lost_joint_) {
      ++state_.lost[j];
      continue;
    }
    state_.position_rad[j] = j == nan_joint_ ? std::numeric_limits<double>::quiet_NaN() : x.q[j];
    state_.velocity_radps[j] = x.qd[j];
    state_.torque_nm[j] = moments_[j].torque_nm;
    state_.mode[j] = static_cast<std::uint8_t>(
        mode_[j].value_or(drives_[j].on ? config_.motor_mode : unitree::kMotorOff));
  }
  const ImuSample imu = robot.imu();
  state_.orientation_wxyz = imu.orientation_wxyz;
  state_.angular_velocity_radps = imu.angular_velocity_radps;
  state_.linear_acceleration_mps2 = imu.linear_acceleration_mps2;
  if (!stuck_) state_.tick_ms = 10'000 + static_cast<std::uint32_t>(2 * cycle_) - back_ms_;
  QueuedState queued{.due_ns = now_ns_, .state = {}};
  encode_state(state_, queued.state);
  if (bad_crc_) queued.state.crc ^= 1;
  if (no_crc_) queued.state.crc = 0;
  const bool lost = loses_ > 0 && cycle_ % static_cast<std::uint64_t>(loses_) == 0;
  if (!silent_ && !lost && now_s >= gap_until_s_) {
    const double held_s = std::max(held_until_s_ - now_s, 0.0);
    const double jitter_s =
        jitter_s_ > 0.0 ? jitter_s_ * 0x1p-64 * static_cast<double>(next_bits(random_)) : 0.0;
    queued.due_ns += static_cast<std::int64_t>(1e9 * (held_s + late_s_ + jitter_s));
    // They do not overtake each other.
    if (!queue_.empty()) queued.due_ns = std::max(queued.due_ns, queue_.back().due_ns);
    queue_.push_back(queued);
  }
  send_due(now_ns_);
}

void UnitreeLink::send_due(std::int64_t now_ns) {
  while (!queue_.empty() && queue_.front().due_ns <= now_ns) {
    peer_.publish(queue_.front().state);
    queue_.pop_front();
    ++states_;
  }
}

LinkFigures UnitreeLink::figures(bool was_enabled) const {
  LinkFigures figures;
  figures.json["states"] = states_;
  figures.json["commands"] = {{"taken", commands_},
                              {"refused", refused_},
                              {"refusal", refusal_},
                              {"writers", peer_.writers()},
                              {"longest_gap_ms", 1e3 * longest_gap_s_}};
  const bool off = std::ranges::none_of(drives_, &Drive::on);
  figures.lines = fmt::format(
      "commands   {} taken, {} refused{}, of {} programs, longest gap {:.2f} ms; {}\n"
      "states     {} sent\n",
      commands_, refused_, refused_ > 0 ? fmt::format(" ({})", refusal_) : "", peer_.writers(),
      1e3 * longest_gap_s_,
      !was_enabled ? "never enabled"
      : off        ? "off"
                   : "NOT off at the end",
      states_);
  if (refused_ > 0) {
    figures.wrong = fmt::format("the robot refused {} commands: {}", refused_, refusal_);
  }
  return figures;
}

}  // namespace sandrunner::hil
