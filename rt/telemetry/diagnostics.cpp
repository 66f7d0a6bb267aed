// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/diagnostics.h"

#include <fmt/format.h>
#include <unistd.h>

#include "rt/core/mode_machine.h"
#include "rt/core/warnings.h"

namespace sandrunner {
namespace {

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

std::string warning_names(std::uint64_t warnings) {
  return names_of_bits(warnings, kNumWarnings, [](int bit) { return kWarningTable[bit].name; });
}

std::string hardware_id(const RobotDescription& robot) {
  char host[65]{};
  if (gethostname(host, sizeof host - 1) != 0) return robot.name;
  return robot.name + "@" + host;
}

Diagnostics::Diagnostics(const RobotDescription& robot)
    : hardware_id_(hardware_id(robot)), joint_names_(robot.joint_names) {}

void Diagnostics::add(const TickRecord& tick) noexcept {
  mode_ = tick.output.mode;
  faults_ = tick.output.faults;
  warnings_ = tick.output.warnings;
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

DiagnosticsMessage Diagnostics::message(std::int64_t stamp_ns) {
  DiagnosticsMessage m{
      .header = {stamp_ns, ""},
      .name = "sandrunner",
      .message = mode_name(mode_),
      .hardware_id = hardware_id_,
      .values = {{"mode", mode_name(mode_)},
                 {"faults", fault_names(faults_)},
                 {"fault_joints",
                  names_of_bits(fault_joints_, kNumJoints, [&](int j) { return joint_names_[j]; })},
                 {"warnings", warning_names(warnings_)},
                 {"tick", std::to_string(tick_)},
                 {"ticks_done", std::to_string(ticks_)},
                 {"slots_missed", std::to_string(skipped_)},
                 {"tick_late_us", histogram_text(late_)},
                 {"read_us", histogram_text(read_)},
                 {"control_us", histogram_text(control_)},
                 {"write_us", histogram_text(write_)}}};
  for (const GateCounterName& counter : kGateCounters) {
    m.values.emplace_back(fmt::format("ticks_{}", counter.name),
                          std::to_string(counters_.*counter.ticks));
  }
  if (skipped_ != skipped_before_) m.warn("slots missed");
  skipped_before_ = skipped_;
  if (warnings_ != 0) m.warn(warning_names(warnings_) + ": lies down");
  if (faults_ != 0) {
    m.level = DiagnosticsMessage::kError;
    m.message += ", " + fault_names(faults_);
  }
  return m;
}

}  // namespace sandrunner
