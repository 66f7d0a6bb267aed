// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/bench.h"

#include <poll.h>
#include <signal.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "drivers/can/can_frame.h"
#include "drivers/robot/bus_listen.h"
#include "drivers/robot/drive.h"
#include "rt/base/clock_ns.h"
#include "tools/hil/can_link.h"

namespace sandrunner::hil {
namespace {

constexpr std::uint64_t kTicksPerQuestion = 40;
constexpr double kBusOff_s = 0.1;
constexpr double kHand_radps = 1.0;
constexpr double kStandInertia_kgm2 = 0.05, kStandFriction_nmsprad = 0.1;

const char* name_of(EmulatedDrive::State state) noexcept {
  switch (state) {
    case EmulatedDrive::State::kOff:
      return "off";
    case EmulatedDrive::State::kOn:
      return "on";
    case EmulatedDrive::State::kTimedOut:
      return "timed out";
    case EmulatedDrive::State::kFault:
      return "fault";
  }
  return "";
}

}  // namespace

Bench::Bench(const ProcessConfig& config, const std::string& imu_device,
             std::vector<TimedFault> faults, double walk_s)
    : hardware_(*config.hardware),
      walk_kp_(config.controller.walk.kp_nmprad),
      walk_s_(walk_s),
      script_(std::move(faults)),
      robot_(config.robot, config.simulator),
      imu_(imu_device, hardware_.imu) {
  for (const BusConfig& bus : hardware_.buses) {
    buses_.push_back({.interface = bus.interface, .socket = open_bus(bus), .foreign = nullptr});
  }
  for (int j = 0; j < kNumJoints; ++j) {
    drives_.emplace_back(hardware_.drives[j], hardware_.drive_timeout_s);
    drives_[j].measure(robot_.state().q[j], robot_.state().qd[j]);
  }
  std::stable_sort(script_.begin(), script_.end(), [](const TimedFault& a, const TimedFault& b) {
    return std::pair(!a.from_start, a.at_s) < std::pair(!b.from_start, b.at_s);
  });
  for (const TimedFault& fault : script_) {
    if (fault.kind == BenchFault::kQueueFull) set_queue(buses_[fault.first].interface, 16);
  }
  lay_ = {robot_.state().position.x, robot_.state().position.y};
}

double Bench::now_s() const noexcept {
  return 1e-9 * static_cast<double>(clock_ns(CLOCK_MONOTONIC) - start_ns_);
}

BenchReport Bench::play(const std::function<bool()>& more, pid_t controller,
                        const std::function<void()>& second) {
  controller_ = controller;
  second_ = second;
  start_ns_ = clock_ns(CLOCK_MONOTONIC);
  for (tick_ = 0; tick_ % kTicksPerQuestion != 0 || more(); ++tick_) {
    const std::int64_t deadline_ns =
        start_ns_ + static_cast<std::int64_t>(tick_ + 1) * kControlPeriod_ns;
    exchange(deadline_ns);
    const double slot_s = static_cast<double>(tick_ + 1) * kControlPeriod_s;
    make_faults(slot_s);
    send_foreign();
    step(slot_s);
    observe(slot_s);
    report_.late_longest_us = std::max(report_.late_longest_us, 1e6 * (now_s() - slot_s));
  }
  // For whoever comes next.
  for (const Bus& bus : buses_) {
    if (bus.down) set_link(bus.interface, true);
  }
  for (const TimedFault& fault : script_) {
    if (fault.kind == BenchFault::kQueueFull) remove_queue(buses_[fault.first].interface);
  }
  return report();
}

// Answers until the tick is over; whoever is late answers once and goes on.
void Bench::exchange(std::int64_t deadline_ns) {
  for (;;) {
    const std::int64_t left_ns = deadline_ns - clock_ns(CLOCK_MONOTONIC);
    const timespec timeout{.tv_sec = 0,
                           .tv_nsec = std::clamp(left_ns, std::int64_t{0}, kControlPeriod_ns)};
    polled_.clear();
    for (const Bus& bus : buses_) polled_.push_back({bus.socket->descriptor(), POLLIN, 0});
    if (ppoll(polled_.data(), polled_.size(), &timeout, nullptr) > 0) {
      for (std::size_t b = 0; b < polled_.size(); ++b) {
        if (polled_[b].revents != 0) answer(buses_[b], static_cast<int>(b));
      }
    }
    if (clock_ns(CLOCK_MONOTONIC) >= deadline_ns) return;
  }
}

void Bench::answer(Bus& bus, int index) {
  std::array<ReceivedFrame, CanSocket::kMaxFrames> received;
  const CanResult got = bus.socket->receive(received);
  std::array<CanFrame, CanSocket::kMaxFrames> replies;
  std::size_t count = 0;
  const double now = now_s();
  for (int i = 0; i < got.frames && !bus.down; ++i) {
    for (int j = 0; j < kNumJoints; ++j) {
      if (hardware_.drives[j].bus != index) continue;
      if (!drives_[j].answer(received[i].frame, now, replies[count])) continue;
      ++count;
      break;
    }
  }
  if (count == 0) return;
  bus.socket->send(std::span(replies).first(count));
  if (received[0].stamp_ns == 0) return;  // the adapter gives none
  const double took_us =
      1e-3 * static_cast<double>(clock_ns(CLOCK_REALTIME) - received[0].stamp_ns);
  ++answers_;
  answer_sum_us_ += took_us;
  report_.answer_longest_us = std::max(report_.answer_longest_us, took_us);
}

void Bench::make_faults(double now_s) {
  for (int j = 0; j < kNumJoints; ++j) {
    if (reboot_end_s_[j] > 0.0 && now_s >= reboot_end_s_[j]) {
      reboot_end_s_[j] = 0.0;
      drives_[j].faults().silent = false;
    }
  }
  for (Bus& bus : buses_) {
    if (bus.back_at_s < 0.0 || now_s < bus.back_at_s) continue;
    bus.back_at_s = -1.0;
    bus.down = false;
    inject(bus.interface, BusEvent::kRestarted);
  }
  while (made_ < script_.size()) {
    const TimedFault& fault = script_[made_];
    if (!fault.from_start && enabled_at_s_ < 0.0) return;
    if (now_s < (fault.from_start ? 0.0 : enabled_at_s_) + fault.at_s) return;
    make(fault, now_s);
    ++made_;
    made_at_s_.push_back(now_s);
    report_.faults.emplace_back();
    report_.faults.back().text = fault.text;
  }
}

void Bench::make(const TimedFault& fault, double now_s) {
  DriveFaults& faults = drives_[fault.first].faults();
  Bus& bus = buses_[std::min<std::size_t>(fault.first, buses_.size() - 1)];
  switch (fault.kind) {
    case BenchFault::kSilent:
      faults.silent = true;
      break;
    case BenchFault::kReboot:
      drives_[fault.first].reboot();
      faults.silent = fault.value > 0.0;
      reboot_end_s_[fault.first] = now_s + fault.value;
      break;
    case BenchFault::kLoses:
      faults.lose_every = static_cast<int>(fault.value);
      break;
    case BenchFault::kSwapped:
      drives_[fault.first].swap_ids(drives_[fault.second]);
      break;
    case BenchFault::kScaled:
      drives_[fault.first].scale_ranges(fault.value);
      break;
    case BenchFault::kMode:
      faults.control_mode = fault.value;
      break;
    case BenchFault::kJumps:
      faults.offset_rad += fault.value;
      break;
    case BenchFault::kTurns:
      on_stand_ = true;
      hand_target_rad_[fault.first] += fault.value;
      break;
    case BenchFault::kCode:
      faults.code = static_cast<std::uint8_t>(fault.value);
      break;
    case BenchFault::kOverTemperature:
      faults.temperature_degc = fault.value;
      break;
    case BenchFault::kReversed:
      faults.reversed = true;
      break;
    case BenchFault::kForeign:
      foreign_left_[fault.first] = static_cast<int>(fault.value);
      break;
    case BenchFault::kSecond:
      if (second_) second_();
      break;
    case BenchFault::kStand:
      on_stand_ = free_joints_ = true;
      break;
    case BenchFault::kBusOff:
      bus.down = true;
      bus.back_at_s = now_s + kBusOff_s;
      inject(bus.interface, BusEvent::kOff);
      break;
    case BenchFault::kLinkDown:
      bus.down = true;
      set_link(bus.interface, false);
      break;
    case BenchFault::kLinkUp:
      set_link(bus.interface, true);
      bus.down = false;
      break;
    case BenchFault::kQueueFull:
      bus.down = true;
      set_queue(bus.interface, 0);
      break;
    case BenchFault::kImuSilent:
      imu_.fault = ImuFault::kSilent;
      break;
    case BenchFault::kImuRepeats:
      imu_.fault = ImuFault::kRepeating;
      break;
    case BenchFault::kImuGarbage:
      imu_.fault = ImuFault::kGarbage;
      break;
    case BenchFault::kDead:
      for (EmulatedDrive& drive : drives_) drive.faults().silent = true;
      imu_.unplug();
      break;
    case BenchFault::kKill:
      if (controller_ > 0) kill(controller_, SIGKILL);
      break;
  }
}

void Bench::send_foreign() {
  if (tick_ % (kControlHz / 1000) != 0) return;
  for (int j = 0; j < kNumJoints; ++j) {
    if (foreign_left_[j] == 0) continue;
    --foreign_left_[j];
    const DriveConfig& drive = hardware_.drives[j];
    std::unique_ptr<CanSocket>& socket = buses_[drive.bus].foreign;
    if (!socket) socket = open_bus(hardware_.buses[drive.bus]);
    CanFrame frame;  // damping, as a controller would that does not walk
    Drive(drive, hardware_).command_frame({.kd_nmsprad = 2.0}, frame);
    socket->send({&frame, 1});
  }
}

void Bench::turn_on_stand(const JointArray<double>& torque_nm) {
  for (int j = 0; j < kNumJoints; ++j) {
    const double most = kHand_radps * kControlPeriod_s;
    double turned = std::clamp(hand_target_rad_[j] - hand_rad_[j], -most, most);
    if (free_joints_) {
      const double friction_nm = kStandFriction_nmsprad * hand_radps_[j];
      hand_radps_[j] += (torque_nm[j] - friction_nm) / kStandInertia_kgm2 * kControlPeriod_s;
      turned = hand_radps_[j] * kControlPeriod_s;
    }
    hand_rad_[j] += turned;
    drives_[j].measure(robot_.state().q[j] + hand_rad_[j],
                       robot_.state().qd[j] + turned / kControlPeriod_s);
  }
}

void Bench::step(double now_s) {
  JointArray<double> torque_nm;
  for (int j = 0; j < kNumJoints; ++j) torque_nm[j] = drives_[j].torque_nm(now_s);
  for (std::size_t f = 0; f < report_.faults.size(); ++f) {
    FaultFigures& figures = report_.faults[f];
    if (figures.limp_after_s) continue;
    for (const double t : torque_nm) {
      figures.largest_torque_nm = std::max(figures.largest_torque_nm, std::fabs(t));
    }
  }
  if (!on_stand_) robot_.step(torque_nm);
  turn_on_stand(torque_nm);
  if (tick_ % static_cast<std::uint64_t>(kControlHz / imu_.base_rate_hz()) == 0) {
    imu_.listen();
    imu_.tick(robot_.imu(), (tick_ + 1) * static_cast<std::uint64_t>(kControlPeriod_ns));
  }
}

void Bench::observe(double now_s) {
  bool on = true, walks = true, damped = true, passive = true, limp = true;
  for (int j = 0; j < kNumJoints; ++j) {
    const EmulatedDrive& drive = drives_[j];
    on = on && drive.state() == EmulatedDrive::State::kOn;
    walks = walks && std::fabs(drive.kp_nmprad() - walk_kp_) < 0.01 * walk_kp_;
    const bool reachable = !drive.faults().silent && !buses_[hardware_.drives[j].bus].down;
    damped = damped && (drive.passive() || !reachable);
    passive = passive && drive.passive();
    limp = limp && drive.limp();
  }
  if (on && enabled_at_s_ < 0.0) enabled_at_s_ = now_s;
  if (on && walks) {
    walk_.push_back({robot_.state().position.x, robot_.state().position.y});
    report_.base_touched = report_.base_touched || robot_.base_contact();
  }
  for (std::size_t f = 0; f < report_.faults.size(); ++f) {
    FaultFigures& figures = report_.faults[f];
    const double since_s = now_s - made_at_s_[f];
    if (damped && !figures.damped_after_s) figures.damped_after_s = since_s;
    if (passive && !figures.passive_after_s) figures.passive_after_s = since_s;
    if (limp && !figures.limp_after_s) figures.limp_after_s = since_s;
  }
}

BenchReport Bench::report() {
  BenchReport& r = report_;
  r.time_s = static_cast<double>(tick_) * kControlPeriod_s;
  r.was_enabled = enabled_at_s_ >= 0.0;
  const auto& base = robot_.state().position;
  r.distance_m = std::hypot(base.x - lay_.x_m, base.y - lay_.y_m);
  std::size_t ticks = walk_.size();
  if (walk_s_ > 0.0) ticks = std::min<std::size_t>(ticks, ticks_from_s(walk_s_));
  r.walked_s = static_cast<double>(walk_.size()) * kControlPeriod_s;
  if (ticks > 1) {
    const std::size_t half = ticks / 2;
    const Place &from = walk_[half], &to = walk_[ticks - 1];
    r.mean_speed_mps = std::hypot(to.x_m - from.x_m, to.y_m - from.y_m) /
                       (static_cast<double>(ticks - 1 - half) * kControlPeriod_s);
  }
  for (int j = 0; j < kNumJoints; ++j) {
    const EmulatedDrive& d = drives_[j];
    r.drives[j] = {.frames = d.frames(),
                   .replies = d.replies(),
                   .time_outs = d.time_outs(),
                   .longest_gap_s = d.longest_gap_s(),
                   .state = name_of(d.state()),
                   .off = d.state() == EmulatedDrive::State::kOff};
  }
  r.imu_packets = imu_.packets();
  r.imu_not_taken = imu_.not_taken();
  if (answers_ > 0) r.answer_mean_us = answer_sum_us_ / static_cast<double>(answers_);
  return r;
}

}  // namespace sandrunner::hil
