// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/dds/diagnostics.h"

#include <fmt/format.h>

#include "rt/core/mode_machine.h"
#include "rt/telemetry/dds/ros.h"
#include "rt/telemetry/dds/ros_time.h"

namespace sandrunner {
namespace {

constexpr int kDepth = 10;
enum Level : std::uint8_t { kOk = 0, kWarn = 1, kError = 2 };  // DiagnosticStatus

std::string histogram_text(const LogHistogram& h) {
  const auto us = [](std::uint64_t ns) { return static_cast<double>(ns) * 1e-3; };
  return fmt::format("p50 {:.1f}, p99 {:.1f}, p99.9 {:.1f}, max {:.1f}", us(h.quantile_ns(0.5)),
                     us(h.quantile_ns(0.99)), us(h.quantile_ns(0.999)), us(h.max_ns()));
}

/// "a, c" for the bits 0 and 2; "none".
template <typename Name>
std::string names_of_bits(std::uint64_t bits, int size, const Name& name) {
  std::string names;
  for (int bit = 0; bit < size; ++bit) {
    if ((bits >> bit & 1) == 0) continue;
    if (!names.empty()) names += ", ";
    names += name(bit);
  }
  return names.empty() ? "none" : names;
}

}  // namespace

std::string fault_names(std::uint64_t faults) {
  return names_of_bits(faults, kNumFaults, [](int bit) {
    return fault_name(static_cast<Fault>(std::uint64_t{1} << bit));
  });
}

Diagnostics::Diagnostics(const DdsParticipant& participant, const RobotDescription& robot)
    : writer_(participant.writer("rt/diagnostics", diagnostic_msgs_msg_dds__DiagnosticArray__desc,
                                 kDepth)),
      joint_names_(robot.joint_names) {}

void Diagnostics::add(const TickRecord& tick) noexcept {
  mode_ = tick.output.mode;
  faults_ = tick.output.faults;
  fault_joints_ = faults_ != 0 ? tick.output.fault_joints : 0;  // which outlives a reset
  tick_ = tick.input.sensors.tick;
  ++ticks_;
  skipped_ += tick.skipped;
  counters_ = tick.counters;
  late_.add(tick.timing.late_ns);
  read_.add(tick.timing.read_ns);
  control_.add(tick.timing.control_ns);
  write_.add(tick.timing.write_ns);
}

Diagnostics::Values Diagnostics::values(const CommandCounts& commands,
                                        std::uint64_t failed_writes) const {
  Values values = {{"mode", mode_name(mode_)},
                   {"faults", fault_names(faults_)},
                   {"fault_joints", names_of_bits(fault_joints_, kNumJoints,
                                                  [&](int j) { return joint_names_[j]; })},
                   {"tick", std::to_string(tick_)},
                   {"ticks_done", std::to_string(ticks_)},
                   {"slots_missed", std::to_string(skipped_)},
                   {"tick_late_us", histogram_text(late_)},
                   {"read_us", histogram_text(read_)},
                   {"control_us", histogram_text(control_)},
                   {"write_us", histogram_text(write_)},
                   {"commands_accepted", std::to_string(commands.accepted)},
                   {"commands_not_finite", std::to_string(commands.not_finite)},
                   {"commands_absurd", std::to_string(commands.absurd)},
                   {"commands_of_other_publisher", std::to_string(commands.other_publisher)},
                   {"requests_accepted", std::to_string(commands.requests_accepted)},
                   {"requests_refused", std::to_string(commands.requests_refused)},
                   {"messages_not_written", std::to_string(failed_writes)}};
  for (const GateCounterName& counter : kGateCounters) {
    values.emplace_back(fmt::format("ticks_{}", counter.name),
                        std::to_string(counters_.*counter.ticks));
  }
  return values;
}

bool Diagnostics::publish(std::int64_t stamp_ns, const CommandCounts& commands,
                          std::uint64_t failed_writes) {
  Values values = this->values(commands, failed_writes);
  std::vector<diagnostic_msgs_msg_dds__KeyValue_> pairs;
  for (auto& [key, value] : values) pairs.push_back({key.data(), value.data()});
  std::string name = "sandrunner", message = mode_name(mode_), hardware;
  const bool missed = skipped_ != skipped_before_;
  skipped_before_ = skipped_;
  if (missed) message += ", slots missed";
  if (faults_ != 0) message += ", " + fault_names(faults_);

  const auto size = static_cast<std::uint32_t>(pairs.size());
  diagnostic_msgs_msg_dds__DiagnosticStatus_ status{
      .level = faults_ != 0 ? kError : (missed ? kWarn : kOk),
      .name = name.data(),
      .message = message.data(),
      .hardware_id = hardware.data(),
      .values = {size, size, pairs.data(), false}};
  diagnostic_msgs_msg_dds__DiagnosticArray_ array{};
  array.header.stamp = ros_time(stamp_ns);
  array.header.frame_id = hardware.data();
  array.status = {1, 1, &status, false};
  return dds_write(writer_, &array) >= 0;
}

}  // namespace sandrunner
