// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/unitree_bench.h"

#include <signal.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "rt/base/clock_ns.h"
#include "rt/core/split_mix.h"
#include "rt/realtime/clock.h"
#include "sim/step/actuator.h"
#include "tools/hil/controller_process.h"

namespace sandrunner::hil {
namespace {

constexpr std::int64_t kCycle_ns = 2'000'000;
constexpr int kTicksPerCycle = kControlHz / 500;
constexpr std::uint64_t kCyclesPerQuestion = 5;
constexpr double kFirmwareTimeout_s = 0.1, kFirmwareDamping_nmsprad = 3.0;
constexpr double kHealthyBattery_percent = 80, kHealthy_degc = 35;
constexpr double kSupply_v = 29.0;

bool has(const std::vector<TimedUnitreeFault>& script, UnitreeFaultKind kind) {
  return std::ranges::any_of(script, [&](const TimedUnitreeFault& f) { return f.kind == kind; });
}

}  // namespace

UnitreeBench::UnitreeBench(const ProcessConfig& config, std::vector<TimedUnitreeFault> faults,
                           double walk_s)
    : config_(config),
      walk_s_(walk_s),
      script_(std::move(faults)),
      peer_(*config.unitree, has(script_, UnitreeFaultKind::kWrongType)),
      robot_(config.robot, config.simulator) {
  std::ranges::stable_sort(script_, [](const TimedUnitreeFault& a, const TimedUnitreeFault& b) {
    return std::pair(!a.from_start, a.at_s) < std::pair(!b.from_start, b.at_s);
  });
  lay_ = {robot_.state().position.x, robot_.state().position.y};
  state_.temperature_degc.fill(static_cast<std::int8_t>(kHealthy_degc));
  state_.battery_percent = static_cast<std::uint8_t>(kHealthyBattery_percent);
  state_.supply_v = kSupply_v;
  state_.remote.on = true;
}

double UnitreeBench::now_s() const noexcept {
  return 1e-9 * static_cast<double>(clock_ns(CLOCK_MONOTONIC) - start_ns_);
}

UnitreeReport UnitreeBench::play(const std::function<bool()>& more, pid_t controller) {
  controller_ = controller;
  start_ns_ = clock_ns(CLOCK_MONOTONIC);
  for (cycle_ = 0; cycle_ % kCyclesPerQuestion != 0 || more(); ++cycle_) {
    const std::int64_t slot_ns = start_ns_ + static_cast<std::int64_t>(cycle_ + 1) * kCycle_ns;
    while (!queue_.empty() && queue_.front().due_ns < slot_ns) {
      sleep_until(queue_.front().due_ns);
      send_due(clock_ns(CLOCK_MONOTONIC));
    }
    sleep_until(slot_ns);
    const std::int64_t now_ns = clock_ns(CLOCK_MONOTONIC);
    const double slot_s = 1e-9 * static_cast<double>(slot_ns - start_ns_);
    peer_.serve();
    peer_.take_commands([&](const unitree::LowCmd& command) { follow(command, now_s()); });
    if (damps_ && now_s() - commanded_s_ > kFirmwareTimeout_s) damp_by_itself();
    make_faults(now_s());
    step();
    send_state(now_ns);
    observe(now_s());
    report_.late_longest_s = std::max(report_.late_longest_s, now_s() - slot_s);
  }
  return report();
}

void UnitreeBench::follow(const unitree::LowCmd& command, double now_s) {
  ++report_.commands;
  if (const char* const mistake = unitree::command_mistake(
          command, static_cast<std::uint8_t>(config_.unitree->motor_mode))) {
    if (report_.refused++ == 0) report_.refusal = mistake;
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
  if (was_on && drives_[0].on) {
    report_.longest_gap_s = std::max(report_.longest_gap_s, now_s - commanded_s_);
  }
  commanded_s_ = now_s;
}

void UnitreeBench::damp_by_itself() {
  for (Drive& drive : drives_) {
    if (drive.on) drive = {.kd = kFirmwareDamping_nmsprad, .on = true};
  }
}

void UnitreeBench::make_faults(double now_s) {
  while (made_ < script_.size()) {
    const TimedUnitreeFault& fault = script_[made_];
    if (!fault.from_start && enabled_at_s_ < 0.0) return;
    if (now_s < (fault.from_start ? 0.0 : enabled_at_s_) + fault.at_s) return;
    make(fault, now_s);
    report_.faults.push_back(
        {.text = fault.text, .damped_after_s = {}, .passive_after_s = {}, .limp_after_s = {}});
    made_at_s_.push_back(now_s);
    ++made_;
  }
}

void UnitreeBench::make(const TimedUnitreeFault& fault, double now_s) {
  using Kind = UnitreeFaultKind;
  const auto j = static_cast<std::size_t>(fault.joint);
  switch (fault.kind) {
    case Kind::kGap:
      gap_until_s_ = now_s + 1e-3 * fault.value;
      break;
    case Kind::kBurst:
      held_until_s_ = now_s + 1e-3 * fault.value;
      break;
    case Kind::kJitter:
      jitter_s_ = 1e-3 * fault.value;
      break;
    case Kind::kLate:
      late_s_ = 1e-3 * fault.value;
      break;
    case Kind::kLoses:
      loses_ = static_cast<int>(fault.value);
      break;
    case Kind::kSilent:
      silent_ = true;
      break;
    case Kind::kBadCrc:
      bad_crc_ = true;
      break;
    case Kind::kNoCrc:
      no_crc_ = true;
      break;
    case Kind::kNan:
      nan_joint_ = fault.joint;
      break;
    case Kind::kStuck:
      stuck_ = true;
      break;
    case Kind::kBackwards:
      back_ms_ = 1000;
      break;
    case Kind::kLost:
      lost_joint_ = fault.joint;
      break;
    case Kind::kHot:
      state_.temperature_degc[j] = static_cast<std::int8_t>(fault.value);
      break;
    case Kind::kMode:
      mode_[j] = static_cast<int>(fault.value);
      break;
    case Kind::kBattery:
      state_.battery_percent = static_cast<std::uint8_t>(fault.value);
      break;
    case Kind::kForeign:
      foreign_left_ = static_cast<int>(fault.value);
      break;
    case Kind::kSport:
      peer_.mode = "mcf";
      sport_ = true;
      break;
    case Kind::kRemoteStop:
      state_.remote.stop = true;
      break;
    case Kind::kRemoteLost:
      state_.remote.on = false;
      break;
    case Kind::kWrongType:
      break;  // from the beginning
    case Kind::kFirmwareDamps:
      damps_ = true;
      break;
    case Kind::kKill:
    case Kind::kCrash:
    case Kind::kStop:
    case Kind::kHang:
    case Kind::kWireKill:
      if (controller_ > 0) signal_controller(fault.kind);
      break;
  }
}

void UnitreeBench::signal_controller(UnitreeFaultKind kind) const {
  using Kind = UnitreeFaultKind;
  if (kind == Kind::kKill) kill(controller_, SIGKILL);
  if (kind == Kind::kCrash) kill(controller_, SIGSEGV);
  if (kind == Kind::kStop) kill(controller_, SIGSTOP);
  if (kind == Kind::kHang) stop_thread(controller_, "control");
  if (kind == Kind::kWireKill) {
    if (const pid_t wire = child_of(child_of(controller_)); wire > 0) kill(wire, SIGKILL);
  }
}

void UnitreeBench::step() {
  const sim::RobotModel<double>& model = config_.robot.model;
  const auto line = sim::drive_line<double>(config_.simulator.torque_speed_line);
  for (int tick = 0; tick < kTicksPerCycle; ++tick) {
    const sim::RigidState<double>& x = robot_.state();
    for (int j = 0; j < kNumJoints; ++j) {
      const Drive& d = drives_[j];
      const auto in_leg = static_cast<std::size_t>(j % kJointsPerLeg);
      torque_nm_[j] = sim::drive_torque(x.q[j], x.qd[j], d.q_rad, d.dq_radps, d.kp, d.kd, d.tau_nm,
                                        model.torque_limit_nm[j], line.stall_torque_nm[in_leg],
                                        line.inverse_no_load_speed[in_leg]);
    }
    robot_.step(torque_nm_);
  }
}

void UnitreeBench::send_state(std::int64_t now_ns) {
  const double now = 1e-9 * static_cast<double>(now_ns - start_ns_);
  if (foreign_left_ > 0 || sport_) {
    unitree::LowCmd foreign;
    unitree::encode_damping(static_cast<std::uint8_t>(config_.unitree->motor_mode), 9.0, foreign);
    peer_.send_foreign(foreign);
    if (foreign_left_ > 0) --foreign_left_;
  }
  const sim::RigidState<double>& x = robot_.state();
  for (int j = 0; j < kNumJoints; ++j) {
    if (j == lost_joint_) {
      ++state_.lost[j];
      continue;
    }
    state_.position_rad[j] = j == nan_joint_ ? std::numeric_limits<double>::quiet_NaN() : x.q[j];
    state_.velocity_radps[j] = x.qd[j];
    state_.torque_nm[j] = torque_nm_[j];
    state_.mode[j] = static_cast<std::uint8_t>(
        mode_[j].value_or(drives_[j].on ? config_.unitree->motor_mode : unitree::kMotorOff));
  }
  const ImuSample imu = robot_.imu();
  state_.orientation_wxyz = imu.orientation_wxyz;
  state_.angular_velocity_radps = imu.angular_velocity_radps;
  state_.linear_acceleration_mps2 = imu.linear_acceleration_mps2;
  if (!stuck_) state_.tick_ms = 10'000 + static_cast<std::uint32_t>(2 * cycle_) - back_ms_;
  QueuedState queued{.due_ns = now_ns, .state = {}};
  encode_state(state_, queued.state);
  if (bad_crc_) queued.state.crc ^= 1;
  if (no_crc_) queued.state.crc = 0;
  const bool lost = loses_ > 0 && cycle_ % static_cast<std::uint64_t>(loses_) == 0;
  if (!silent_ && !lost && now >= gap_until_s_) {
    const double held_s = std::max(held_until_s_ - now, 0.0);
    const double jitter_s =
        jitter_s_ > 0.0 ? jitter_s_ * 0x1p-64 * static_cast<double>(next_bits(random_)) : 0.0;
    queued.due_ns += static_cast<std::int64_t>(1e9 * (held_s + late_s_ + jitter_s));
    // They do not overtake each other.
    if (!queue_.empty()) queued.due_ns = std::max(queued.due_ns, queue_.back().due_ns);
    queue_.push_back(queued);
  }
  send_due(now_ns);
}

void UnitreeBench::send_due(std::int64_t now_ns) {
  while (!queue_.empty() && queue_.front().due_ns <= now_ns) {
    peer_.publish(queue_.front().state);
    queue_.pop_front();
    ++report_.states;
  }
}

void UnitreeBench::observe(double now_s) {
  const double walk_kp = config_.controller.walk.kp_nmprad;
  bool on = true, walks = walk_kp > 0.0, damped = true, limp = true;
  for (int j = 0; j < kNumJoints; ++j) {
    const Drive& d = drives_[j];
    on = on && d.on;
    walks = walks && std::fabs(d.kp - walk_kp) < 0.01 * walk_kp;
    damped = damped && d.kp == 0.0 && d.tau_nm == 0.0;
    limp = limp && d.kp == 0.0 && d.tau_nm == 0.0 && d.kd == 0.0;
  }
  if (on && enabled_at_s_ < 0.0) enabled_at_s_ = now_s;
  if (on && walks) {
    walk_.push_back({robot_.state().position.x, robot_.state().position.y});
    report_.base_touched = report_.base_touched || robot_.base_contact();
  }
  report_.off_at_end = std::ranges::none_of(drives_, &Drive::on);
  for (std::size_t f = 0; f < report_.faults.size(); ++f) {
    FaultFigures& figures = report_.faults[f];
    const double since_s = now_s - made_at_s_[f];
    if (damped && !figures.damped_after_s) {
      figures.damped_after_s = figures.passive_after_s = since_s;
    }
    if (limp && !figures.limp_after_s) figures.limp_after_s = since_s;
    if (figures.limp_after_s) continue;
    for (const double torque_nm : torque_nm_) {
      figures.largest_torque_nm = std::max(figures.largest_torque_nm, std::fabs(torque_nm));
    }
  }
}

UnitreeReport UnitreeBench::report() {
  UnitreeReport& r = report_;
  r.time_s = 1e-9 * static_cast<double>(static_cast<std::int64_t>(cycle_) * kCycle_ns);
  r.was_enabled = enabled_at_s_ >= 0.0;
  r.writers = peer_.writers();
  if (r.was_enabled && commanded_s_ > enabled_at_s_) {
    r.command_rate_hz = static_cast<double>(r.commands) / commanded_s_;
  }
  const auto& base = robot_.state().position;
  r.distance_m = std::hypot(base.x - lay_.x_m, base.y - lay_.y_m);
  const double cycle_s = 1e-9 * static_cast<double>(kCycle_ns);
  r.walked_s = static_cast<double>(walk_.size()) * cycle_s;
  std::size_t cycles = walk_.size();
  if (walk_s_ > 0.0) cycles = std::min(cycles, static_cast<std::size_t>(walk_s_ / cycle_s));
  if (cycles > 1) {
    const std::size_t half = cycles / 2;
    const Place &from = walk_[half], &to = walk_[cycles - 1];
    r.mean_speed_mps = std::hypot(to.x_m - from.x_m, to.y_m - from.y_m) /
                       (static_cast<double>(cycles - 1 - half) * cycle_s);
  }
  return r;
}

}  // namespace sandrunner::hil
