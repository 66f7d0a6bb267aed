// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/can_link.h"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <utility>

#include "drivers/can/can_frame.h"
#include "drivers/robot/bus_listen.h"
#include "drivers/robot/drive.h"
#include "rt/base/clock_ns.h"
#include "tools/hil/can_interface.h"

namespace sandrunner::hil {
namespace {

constexpr double kBusOff_s = 0.1;
constexpr double kHand_radps = 1.0;
constexpr double kStandInertia_kgm2 = 0.05, kStandFriction_nmsprad = 0.1;
constexpr unsigned kQueue_frames = 16;

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

CanLink::CanLink(const HardwareConfig& hardware, const RobotDescription& description,
                 const sim::Simulator& robot, const std::string& imu_device,
                 std::span<const TimedFault> script)
    : hardware_(hardware), description_(description), imu_(imu_device, hardware.imu) {
  for (const BusConfig& bus : hardware_.buses) {
    buses_.push_back({.interface = bus.interface, .socket = open_bus(bus), .foreign = nullptr});
  }
  const sim::RigidState<double>& x = robot.state().robot.rigid;
  for (int j = 0; j < kNumJoints; ++j) {
    drives_.emplace_back(hardware_.drives[j], hardware_.drive_timeout_s);
    drives_[j].measure(x.q[j], x.qd[j]);
  }
  for (const TimedFault& fault : script) {
    if (fault.kind != "queue-full") continue;
    buses_[fault.first].has_queue = true;
    set_queue(buses_[fault.first].interface, kQueue_frames);
  }
}

CanLink::~CanLink() {
  for (const Bus& bus : buses_) {
    if (bus.down) set_link(bus.interface, true);
    if (bus.has_queue) remove_queue(bus.interface);
  }
}

std::string CanLink::greeting() const {
  return "twelve drives and the IMU are there; Ctrl-C ends them";
}

// Answers until the tick is over; a link that is late answers once and goes on.
double CanLink::exchange(std::int64_t end_ns) {
  for (;;) {
    const std::int64_t left_ns = end_ns - clock_ns(CLOCK_MONOTONIC);
    const timespec timeout{.tv_sec = 0,
                           .tv_nsec = std::clamp(left_ns, std::int64_t{0}, kControlPeriod_ns)};
    polled_.clear();
    for (const Bus& bus : buses_) polled_.push_back({bus.socket->descriptor(), POLLIN, 0});
    if (ppoll(polled_.data(), polled_.size(), &timeout, nullptr) > 0) {
      for (std::size_t b = 0; b < polled_.size(); ++b) {
        if (polled_[b].revents != 0) answer(buses_[b], static_cast<int>(b));
      }
    }
    if (clock_ns(CLOCK_MONOTONIC) >= end_ns) break;
  }
  const double slot_s = static_cast<double>(tick_ + 1) * kControlPeriod_s;
  end_faults(slot_s);
  return slot_s;
}

void CanLink::answer(Bus& bus, int index) {
  std::array<ReceivedFrame, CanSocket::kMaxFrames> received;
  const CanResult got = bus.socket->receive(received);
  std::array<CanFrame, CanSocket::kMaxFrames> replies;
  std::size_t count = 0;
  const double now = now_s();
  for (int i = 0; i < got.frames && !bus.down; ++i) {
    for (int j = 0; j < kNumJoints; ++j) {
      if (hardware_.drives[j].bus != index) continue;
      if (!drives_[j].answer(received[i].frame, now, replies[count])) continue;
      commanded_s_ = now;
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
  answer_longest_us_ = std::max(answer_longest_us_, took_us);
}

void CanLink::end_faults(double now_s) {
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
}

std::span<const LinkFault<CanLink>> CanLink::faults() {
  using F = const TimedFault&;
  static constexpr auto kFaults =
      std::to_array<LinkFault<CanLink>>({
          {{"silent", Takes::kJoint, "JOINT: the drive receives and sends nothing"},
           [](CanLink& l, F f) { l.faults(f).silent = true; }},
          {{"reboot", Takes::kJointAndNumber, "JOINT S: off, and back after S s"},
           [](CanLink& l, F f) { l.reboot(f); }},
          {{"loses", Takes::kJointAndNumber, "JOINT N: one of N replies is lost"},
           [](CanLink& l, F f) { l.faults(f).lose_every = static_cast<int>(f.value); }},
          {{"swapped", Takes::kTwoJoints, "JOINT JOINT: each has the other's id"},
           [](CanLink& l, F f) { l.drives_[f.first].swap_ids(l.drives_[f.second]); }},
          {{"scaled", Takes::kJointAndNumber,
            "JOINT X: its numbers span X times what is configured (MIT layout)"},
           [](CanLink& l, F f) { l.drives_[f.first].scale_ranges(f.value); }},
          {{"mode", Takes::kJointAndNumber, "JOINT N: its control mode (Damiao)"},
           [](CanLink& l, F f) { l.faults(f).control_mode = f.value; }},
          {{"jumps", Takes::kJointAndNumber, "JOINT RAD: its encoder jumps"},
           [](CanLink& l, F f) { l.faults(f).offset_rad += f.value; }},
          {{"turns", Takes::kJointAndNumber, "JOINT RAD: a hand turns it, on a stand"},
           [](CanLink& l, F f) {
             l.on_stand_ = true;
             l.hand_target_rad_[f.first] += f.value;
           }},
          {{"code", Takes::kJointAndNumber, "JOINT N: a fault of its own"},
           [](CanLink& l, F f) { l.faults(f).code = static_cast<std::uint8_t>(f.value); }},
          {{"hot", Takes::kJointAndNumber, "JOINT DEGC: its temperature"},
           [](CanLink& l, F f) { l.faults(f).temperature_degc = f.value; }},
          {{"reversed", Takes::kJoint, "JOINT: its torque acts the other way"},
           [](CanLink& l, F f) { l.faults(f).reversed = true; }},
          {{"untimed", Takes::kNothing, "no drive has a time-out: each keeps to its last command"},
           [](CanLink& l, F) {
             for (EmulatedDrive& drive : l.drives_) drive.faults().untimed = true;
           }},
          {{"foreign", Takes::kJointAndNumber,
            "JOINT N: another program sends it N set-points, at 1 kHz"},
           [](CanLink& l, F f) { l.foreign_left_[f.first] = static_cast<int>(f.value); }},
          {{"stand", Takes::kNothing,
            "on a stand, where each joint turns under its drive's torque"},
           [](CanLink& l, F) { l.on_stand_ = l.free_joints_ = true; }},
          {{"bus-off", Takes::kBus, "INTERFACE: off for 0.1 s"},
           [](CanLink& l, F f) { l.bus_off(l.buses_[f.first]); }},
          {{"link-down", Takes::kBus, "INTERFACE: set down"},
           [](CanLink& l, F f) { l.set_down(f, true); }},
          {{"link-up", Takes::kBus, "INTERFACE: set up"},
           [](CanLink& l, F f) { l.set_down(f, false); }},
          {{"queue-full", Takes::kBus, "INTERFACE: takes no frames (ENOBUFS)"},
           [](CanLink& l, F f) {
             l.buses_[f.first].down = true;
             set_queue(l.buses_[f.first].interface, 0);
           }},
          {{"imu-silent", Takes::kNothing, "the IMU sends nothing"},
           [](CanLink& l, F) { l.imu_.fault = ImuFault::kSilent; }},
          {{"imu-repeats", Takes::kNothing, "the IMU repeats its last packet"},
           [](CanLink& l, F) { l.imu_.fault = ImuFault::kRepeating; }},
          {{"imu-garbage", Takes::kNothing, "the IMU sends garbage"},
           [](CanLink& l, F) { l.imu_.fault = ImuFault::kGarbage; }},
          {{"dead", Takes::kNothing, "the whole bench ends"}, [](CanLink& l, F) { l.die(); }},
      });
  return kFaults;
}

bool CanLink::make(const TimedFault& fault, double now_s) {
  fault_s_ = now_s;
  return make_fault(faults(), *this, fault);
}

void CanLink::reboot(const TimedFault& fault) {
  drives_[fault.first].reboot();
  faults(fault).silent = fault.value > 0.0;
  reboot_end_s_[fault.first] = fault_s_ + fault.value;
}

void CanLink::bus_off(Bus& bus) {
  bus.down = true;
  bus.back_at_s = fault_s_ + kBusOff_s;
  inject(bus.interface, BusEvent::kOff);
}

void CanLink::set_down(const TimedFault& fault, bool down) {
  buses_[fault.first].down = down;
  set_link(buses_[fault.first].interface, !down);
}

void CanLink::die() {
  for (EmulatedDrive& drive : drives_) drive.faults().silent = true;
  imu_.unplug();
}

void CanLink::send_foreign() {
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

void CanLink::turn_on_stand(const sim::Simulator& robot) {
  const sim::RigidState<double>& x = robot.state().robot.rigid;
  for (int j = 0; j < kNumJoints; ++j) {
    const double most = kHand_radps * kControlPeriod_s;
    double turned = std::clamp(hand_target_rad_[j] - hand_rad_[j], -most, most);
    if (free_joints_) {
      const double friction_nm = kStandFriction_nmsprad * hand_radps_[j];
      hand_radps_[j] +=
          (moments_[j].torque_nm - friction_nm) / kStandInertia_kgm2 * kControlPeriod_s;
      turned = hand_radps_[j] * kControlPeriod_s;
    }
    hand_rad_[j] += turned;
    drives_[j].measure(x.q[j] + hand_rad_[j], x.qd[j] + turned / kControlPeriod_s);
  }
}

const JointArray<DriveMoment>& CanLink::step(double now_s, sim::Simulator& robot) {
  send_foreign();
  JointArray<double> torque_nm;
  for (int j = 0; j < kNumJoints; ++j) {
    torque_nm[j] = moments_[j].torque_nm = drives_[j].torque_nm(now_s);
  }
  if (!on_stand_) robot.step(torque_nm);
  turn_on_stand(robot);
  if (tick_ % static_cast<std::uint64_t>(kControlHz / imu_.base_rate_hz()) == 0) {
    imu_.listen();
    imu_.tick(robot.imu(), (tick_ + 1) * static_cast<std::uint64_t>(kControlPeriod_ns));
  }
  ++tick_;
  for (int j = 0; j < kNumJoints; ++j) {
    const EmulatedDrive& drive = drives_[j];
    DriveMoment& moment = moments_[j];
    moment.on = drive.state() == EmulatedDrive::State::kOn;
    moment.off = drive.state() == EmulatedDrive::State::kOff;
    moment.reachable = !drive.faults().silent && !buses_[hardware_.drives[j].bus].down;
    moment.passive = drive.passive();
    moment.limp = drive.limp();
    moment.kp_nmprad = drive.kp_nmprad();
  }
  return moments_;
}

LinkFigures CanLink::figures(bool was_enabled) const {
  LinkFigures figures;
  std::uint64_t frames = 0, replies = 0, time_outs = 0;
  double gap_s = 0.0;
  std::string states;
  bool same = true;
  for (int j = 0; j < kNumJoints; ++j) {
    const EmulatedDrive& d = drives_[j];
    const std::string& name = description_.joint_names[j];
    figures.json["drives"][name] = {{"frames", d.frames()},
                                    {"replies", d.replies()},
                                    {"state", name_of(d.state())},
                                    {"time_outs", d.time_outs()},
                                    {"longest_gap_ms", 1e3 * d.longest_gap_s()}};
    frames += d.frames();
    replies += d.replies();
    time_outs += d.time_outs();
    gap_s = std::max(gap_s, d.longest_gap_s());
    same = same && d.state() == drives_[0].state();
    states += fmt::format(" {} {}", name, name_of(d.state()));
  }
  const double mean_us = answers_ > 0 ? answer_sum_us_ / static_cast<double>(answers_) : 0.0;
  figures.json["imu"] = {{"packets", imu_.packets()}, {"not_taken", imu_.not_taken()}};
  figures.json["answer_us"] = {{"mean", mean_us}, {"longest", answer_longest_us_}};
  figures.lines = fmt::format(
      "drives     {} frames, {} answered, {} time-outs, longest gap {:.2f} ms; {}{}\n"
      "IMU        {} packets, {} not taken\n",
      frames, replies, time_outs, 1e3 * gap_s, was_enabled ? "" : "never all enabled; ",
      same ? fmt::format("all {}", name_of(drives_[0].state())) : "at the end" + states,
      imu_.packets(), imu_.not_taken());
  figures.bench = fmt::format("answers {:.0f} us after the kernel's receipt, {:.0f} at most; ",
                              mean_us, answer_longest_us_);
  return figures;
}

}  // namespace sandrunner::hil
