// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/robot/can_robot.h"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <utility>

#include "drivers/robot/bring_up.h"
#include "drivers/robot/bus_listen.h"
#include "drivers/robot/bus_plan.h"
#include "rt/base/clock_ns.h"
#include "rt/core/joint_pd.h"

namespace sandrunner {
namespace {

constexpr int kMostRounds = 3;  // of reading a bus in a tick

/// The tick in which something of `age_ns` happened, seen from `tick`.
std::uint64_t tick_of(std::int64_t age_ns, std::uint64_t tick) noexcept {
  const auto ago =
      static_cast<std::uint64_t>(std::max<std::int64_t>(age_ns, 0) / kControlPeriod_ns);
  return tick - std::min(ago, tick);
}

std::unique_ptr<EmergencyStop> open_emergency_stop(const StopLineConfig& config) {
  if (config.chip.empty()) return nullptr;
  const auto line = std::make_shared<StopLine>(config);
  return std::make_unique<EmergencyStop>([line] { return line->high(); });
}

const HardwareConfig& within_capacity(const HardwareConfig& config) {
  require_capacity(config);
  return config;
}

}  // namespace

SetPoint set_point(const SafeCommand& command, int j, const Drive& drive, DriveMode mode,
                   bool answers) noexcept {
  const JointCommand& c = command.joints();
  const bool blind = (command.blind_joints() >> j & 1) != 0;
  if (blind && (answers || mode == DriveMode::kTorque)) return {};
  if (mode == DriveMode::kGains) {
    return {c.position_rad[j], c.velocity_radps[j], c.kp_nmprad[j], c.kd_nmsprad[j],
            c.feedforward_nm[j]};
  }
  return {.torque_nm = joint_torque(drive.position_rad(), drive.velocity_radps(), c.position_rad[j],
                                    c.velocity_radps[j], c.kp_nmprad[j], c.kd_nmsprad[j],
                                    c.feedforward_nm[j])};
}

CanRobot::CanRobot(const HardwareConfig& config, const RobotDescription& robot,
                   const GateConfig& gate, std::unique_ptr<CanGuard> guard)
    : config_(within_capacity(config)),
      guard_(std::move(guard)),
      emergency_stop_(open_emergency_stop(config.emergency_stop)),
      sockets_(open_silent_buses(config, robot)),
      imu_(config.imu),
      counters_(config.buses.size()),
      off_frames_(off_frames(config, false)) {
  for (int j = 0; j < kNumJoints; ++j) drives_[j] = Drive(config.drives[j], config);
  require_drives(config, robot, gate, sockets_);
  if (guard_) guard_->start();
  switch_off();  // the first tick is to know where the joints are
}

CanRobot::~CanRobot() = default;

void CanRobot::read(std::uint64_t tick, SensorFrame& frame) noexcept {
  tick_ = tick;
  if (guard_ && guard_->has_cut()) cut_.store(true, std::memory_order_relaxed);
  receive(tick);
  std::uint64_t foreign = 0;
  for (int j = 0; j < kNumJoints; ++j) {
    const Drive& drive = drives_[j];
    frame.joints.drive_fault[j] = drive.fault();
    frame.joints.drive_warning[j] = drive.warning();
    if (drive.has_foreign_traffic(tick)) foreign |= std::uint64_t{1} << j;
    if (drive.replies() == 0) continue;
    frame.joints.position_rad[j] = drive.position_rad();
    frame.joints.velocity_radps[j] = drive.velocity_radps();
    frame.joints.torque_nm[j] = drive.torque_nm();
    frame.joints.tick[j] = drive.tick();
  }
  if (imu_.poll()) {
    frame.imu = imu_.sample();
    frame.imu.tick = tick_of(clock_ns(CLOCK_MONOTONIC) - imu_.sample_time_ns(), tick);
  }
  const bool stop = emergency_stop_ && emergency_stop_->pressed(clock_ns(CLOCK_MONOTONIC));
  frame.emergency_stop = stop ? 1 : 0;
  frame.drives_cut = cut_.load(std::memory_order_relaxed) ? 1 : 0;
  // The drives answer what cut_drives() sends, too.
  frame.foreign_traffic = frame.drives_cut != 0 ? 0 : foreign;
}

void CanRobot::receive(std::uint64_t tick) noexcept {
  const std::int64_t now = clock_ns(CLOCK_REALTIME);  // of the kernel's stamps
  const std::int64_t monotonic = clock_ns(CLOCK_MONOTONIC);
  const std::int64_t longest = monotonic - emptied_ns_;
  bool emptied = true;
  for (std::size_t b = 0; b < sockets_.size(); ++b) {
    const bool all = for_each_frame(*sockets_[b], kMostRounds, [&](const ReceivedFrame& received) {
      take(static_cast<int>(b), received, tick, now, longest);
    });
    emptied = emptied && all;
    counters_[b].overflowed = sockets_[b]->overflowed();
  }
  if (emptied) emptied_ns_ = monotonic;
}

void CanRobot::take(int bus, const ReceivedFrame& received, std::uint64_t tick, std::int64_t now,
                    std::int64_t longest) noexcept {
  BusCounters& counters = counters_[bus];
  if (received.frame.error) {
    const CanError error = decode_can_error(received.frame);
    ++(error.bus_off ? counters.bus_off : counters.errors);
    if (!error.bus_off) return;
    for (int j = 0; j < kNumJoints; ++j) {
      if (config_.drives[j].bus == bus) drives_[j].lose_bus();
    }
    return;
  }
  ++counters.received;
  const std::uint64_t when =
      received.stamp_ns == 0 ? tick : tick_of(frame_age_ns(received.stamp_ns, now, longest), tick);
  for (int j = 0; j < kNumJoints; ++j) {
    if (config_.drives[j].bus == bus && drives_[j].take(received.frame, when)) return;
  }
  bool is_command = false;
  for (int j = 0; j < kNumJoints; ++j) {
    if (config_.drives[j].bus != bus || !drives_[j].is_command(received.frame)) continue;
    is_command = true;
    drives_[j].note_foreign_command(when);
  }
  if (!is_command) ++counters.foreign;
}

void CanRobot::write(const SafeCommand& command) noexcept {
  const bool enabled = command.enabled() && !cut_.load(std::memory_order_relaxed);
  // What takes torque away does not wait for its turn.
  const bool at_once = enabled_ && !enabled;
  enabled_ = enabled;
  if (tick_ < next_exchange_ && !at_once) return;
  const auto period = static_cast<std::uint64_t>(config_.ticks_per_exchange());
  next_exchange_ = (tick_ / period + 1) * period;
  exchange(enabled ? &command : nullptr);
}

void CanRobot::exchange(const SafeCommand* command) noexcept {
  if (guard_ && command) guard_->note_command(clock_ns(CLOCK_MONOTONIC));
  std::array<CanFrame, kNumJoints> frames;
  for (std::size_t b = 0; b < sockets_.size(); ++b) {
    std::size_t count = 0;
    for (int j = 0; j < kNumJoints; ++j) {
      if (config_.drives[j].bus != static_cast<int>(b)) continue;
      SetPoint point;
      if (command != nullptr) {
        const Drive& d = drives_[j];
        const bool answers = tick_ - d.tick() <= 2 * std::uint64_t(config_.ticks_per_exchange());
        point = set_point(*command, j, d, config_.mode, answers);
      }
      if (drives_[j].next_frame(command != nullptr ? &point : nullptr, tick_, frames[count])) {
        ++count;
      }
    }
    const int bus = static_cast<int>(b);
    const std::span<const CanFrame> sent = std::span(frames).first(count);
    const auto send_to_bus = [&](std::span<const CanFrame> f) { send(bus, f); };
    if (command == nullptr) {
      send(bus, sent);
    } else {
      send_unless_cut(cut_, sent, off_frames_[b], send_to_bus);
    }
  }
  if (guard_ && !command) guard_->note_off();
}

void CanRobot::send(int bus, std::span<const CanFrame> frames) noexcept {
  if (frames.empty()) return;
  const CanResult result = sockets_[bus]->send(frames);
  counters_[bus].sent += static_cast<std::uint64_t>(result.frames);
  counters_[bus].not_sent += frames.size() - static_cast<std::uint64_t>(result.frames);
  if (result.status != CanStatus::kOk) counters_[bus].refusal = result.status;
}

void CanRobot::cut_drives() noexcept {
  cut_.store(true);
  for (std::size_t b = 0; b < sockets_.size(); ++b) sockets_[b]->send(off_frames_[b]);
}

void CanRobot::shut_down() noexcept { switch_off(); }

void CanRobot::switch_off() noexcept {
  for (int i = 0; i < 50; ++i) {
    exchange(nullptr);
    const timespec pause{.tv_sec = 0, .tv_nsec = 2'000'000};
    nanosleep(&pause, nullptr);
    receive(tick_);
    // One answer may still be to an earlier command.
    if (std::ranges::all_of(drives_, [](const Drive& d) { return d.replies_off() >= 2; })) return;
  }
}

std::string hardware_report(const CanRobot& robot, const HardwareConfig& config,
                            const RobotDescription& description) {
  std::string lines;
  for (std::size_t b = 0; b < config.buses.size(); ++b) {
    const BusCounters& c = robot.bus_counters()[b];
    lines += fmt::format("{}: {} frames sent, {} received", config.buses[b].interface, c.sent,
                         c.received);
    if (c.not_sent > 0) lines += fmt::format(", {} NOT SENT ({})", c.not_sent, words(c.refusal));
    if (c.foreign > 0) lines += fmt::format(", {} not from these drives", c.foreign);
    if (c.overflowed > 0) lines += fmt::format(", {} LOST in the kernel", c.overflowed);
    if (c.bus_off > 0) lines += fmt::format(", BUS OFF {} times", c.bus_off);
    if (c.errors > 0) lines += fmt::format(", {} error frames", c.errors);
    lines += '\n';
  }
  for (int j = 0; j < kNumJoints; ++j) {
    const Drive& d = robot.drives()[j];
    const std::uint64_t missing = d.sent() - std::min(d.sent(), d.replies());
    const std::uint64_t foreign = d.foreign_commands() + d.surplus_replies();
    const std::uint64_t trouble = d.last_fault() | d.last_warning();
    if (missing <= 1 && trouble == 0 && d.bad() == 0 && foreign == 0) continue;
    lines += fmt::format("{}: {} of {} commands not answered", description.joint_names[j], missing,
                         d.sent());
    if (d.bad() > 0) lines += fmt::format(", {} replies of a wrong length", d.bad());
    if (d.foreign_commands() > 0) {
      lines += fmt::format(", {} COMMANDS OF ANOTHER PROGRAM", d.foreign_commands());
    }
    if (d.surplus_replies() > 0) {
      lines += fmt::format(", {} replies that were not asked for", d.surplus_replies());
    }
    if (trouble != 0) lines += "; " + drive_fault_words(config.drives[j], trouble);
    lines += '\n';
  }
  const Imu::Counters imu = robot.imu().counters();
  lines += fmt::format("{}: {} samples", config.imu.device, imu.samples);
  if (imu.repeated > 0) lines += fmt::format(", {} REPEATED", imu.repeated);
  if (imu.incomplete > 0) lines += fmt::format(", {} incomplete", imu.incomplete);
  if (imu.wrong_length > 0) lines += fmt::format(", {} of a wrong length", imu.wrong_length);
  if (imu.clock_restarts > 0)
    lines += fmt::format(", {} RESTARTS of its clock", imu.clock_restarts);
  if (imu.bad_checksums > 0) lines += fmt::format(", {} bad checksums", imu.bad_checksums);
  if (imu.skipped_bytes > 0) lines += fmt::format(", {} bytes skipped", imu.skipped_bytes);
  return lines + '\n';
}

}  // namespace sandrunner
