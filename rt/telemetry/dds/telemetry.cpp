// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/dds/telemetry.h"

#include <string>

#include "rt/telemetry/start_time.h"

namespace sandrunner {
namespace {

constexpr std::int64_t kTick_ns = 1'000'000'000 / kControlHz;

void add_counts(DiagnosticsMessage& message, const CommandCounts& commands,
                std::uint64_t failed_writes) {
  const auto add = [&](const char* key, std::uint64_t count) {
    message.values.emplace_back(key, std::to_string(count));
  };
  add("commands_accepted", commands.accepted);
  add("commands_not_finite", commands.not_finite);
  add("commands_absurd", commands.absurd);
  add("commands_of_other_publisher", commands.other_publisher);
  add("requests_accepted", commands.requests_accepted);
  add("requests_refused", commands.requests_refused);
  add("messages_not_written", failed_writes);
}

}  // namespace

Telemetry::Telemetry(const DdsParticipant& participant, const DdsConfig& config,
                     const RobotDescription& robot, const CommandInbox* inbox)
    : ros_hz_(static_cast<std::uint64_t>(config.ros_hz)),
      inbox_(inbox),
      ros_(participant, robot),
      diagnostics_(robot),
      odometry_(robot) {
  if (config.ticks) batches_.emplace(participant);
}

Telemetry::~Telemetry() {
  if (batches_) batches_->flush();
}

void Telemetry::add(const TickRecord& record) {
  const std::uint64_t tick = record.input.sensors.tick;
  if (start_ns_ == 0) start_ns_ = start_time_ns(record);
  const std::int64_t stamp_ns = start_ns_ + static_cast<std::int64_t>(tick) * kTick_ns;
  odometry_.add(record);
  diagnostics_.add(record);
  if (batches_ && !batches_->add(record, stamp_ns)) ++failed_writes_;
  // Due when the tick enters a new slot of the slower rate, even if the slot's first tick is
  // missing.
  const auto due = [&](std::uint64_t hz) {
    return tick * hz / kControlHz != last_tick_ * hz / kControlHz;
  };
  if (due(ros_hz_)) {
    failed_writes_ += static_cast<std::uint64_t>(ros_.publish(record, odometry_, stamp_ns));
  }
  if (due(1)) {
    DiagnosticsMessage message = diagnostics_.message(stamp_ns);
    add_counts(message, inbox_ ? inbox_->counts() : CommandCounts{}, failed_writes_);
    if (!ros_.publish(message)) ++failed_writes_;
  }
  last_tick_ = tick;
}

}  // namespace sandrunner
