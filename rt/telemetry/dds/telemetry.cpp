// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/dds/telemetry.h"

#include <fmt/format.h>

#include <string>
#include <thread>

#include "rt/base/standard_error.h"

namespace sandrunner {
namespace {

void add_counts(DiagnosticsMessage& message, const CommandCounts& commands,
                std::uint64_t failed_writes) {
  const auto add = [&](const char* key, std::uint64_t count) {
    message.values.emplace_back(key, std::to_string(count));
  };
  add("commands_accepted", commands.accepted);
  add("commands_not_finite", commands.not_finite);
  add("commands_absurd", commands.absurd);
  add("commands_of_other_publisher", commands.other_publisher);
  add("commands_beside_another_robot", commands.objected);
  add("requests_accepted", commands.requests_accepted);
  add("requests_refused", commands.requests_refused);
  add("messages_not_written", failed_writes);
}

}  // namespace

Telemetry::Telemetry(const DdsParticipant& participant, const DdsConfig& config,
                     const RobotDescription& robot, const OperatorDesk* desk, RunClock clock)
    : ros_rate_(config.ros_hz),
      desk_(desk),
      ros_(participant, robot),
      neighbours_(participant, config.stamped_cmd_vel),
      diagnostics_(robot),
      odometry_(robot) {
  // Nothing at tick 0: no reader has been found yet.
  for (SlowerRate* rate : {&ros_rate_, &batch_rate_, &diagnostics_rate_}) rate->due(0);
  if (clock == RunClock::kLockstep) clock_.emplace(participant);
  if (config.ticks) batches_.emplace(participant);
}

Telemetry::~Telemetry() {
  if (batches_) batches_->flush();
}

void Telemetry::begin(std::int64_t start_ns) noexcept {
  start_ns_ = start_ns;
  start_ = std::chrono::steady_clock::now();
}

void Telemetry::add(const TickRecord& record) {
  const std::uint64_t tick = record.input.sensors.tick;
  const std::chrono::nanoseconds time(static_cast<std::int64_t>(tick) * kControlPeriod_ns);
  const std::int64_t stamp_ns = start_ns_ + time.count();
  const bool ros_due = ros_rate_.due(tick), batch_due = batch_rate_.due(tick);
  if (clock_ && (ros_due || batch_due)) {
    std::this_thread::sleep_until(start_ + time);
    if (!clock_->publish(stamp_ns)) ++failed_writes_;
  }
  odometry_.add(record.input, record.output);
  diagnostics_.add(record);
  if (batches_ && !batches_->add(record, stamp_ns)) ++failed_writes_;
  if (ros_due) {
    failed_writes_ += static_cast<std::uint64_t>(ros_.publish(record, odometry_, stamp_ns));
  }
  if (diagnostics_rate_.due(tick)) {
    DiagnosticsMessage message = diagnostics_.message(stamp_ns);
    if (desk_ && desk_->no_walk()) message.warn(desk_->no_walk());
    if (desk_) add_neighbours(message);
    add_counts(message, desk_ ? desk_->counts() : CommandCounts{}, failed_writes_);
    if (!ros_.publish(message)) ++failed_writes_;
  }
}

// What an operator would wonder about: it is in the diagnostics, and once on standard error.
void Telemetry::add_neighbours(DiagnosticsMessage& message) {
  const Neighbours neighbours = neighbours_.look();
  message.values.emplace_back("last_request", desk_->last_request());
  message.values.emplace_back("other_robots", joined(neighbours.robots));
  message.values.emplace_back("other_cmd_vel_types", joined(neighbours.other_commands));
  if (!neighbours.other_commands.empty()) message.warn("rt/cmd_vel of another type is not read");
  if (neighbours.robots.empty()) return;
  message.warn("another robot would obey as well");
  if (alone_) {
    to_standard_error(
        fmt::format("sandrunner: another robot in this DDS domain would obey as well ({}): only "
                    "stop and damp are accepted\n",
                    joined(neighbours.robots)));
  }
  alone_ = false;
}

}  // namespace sandrunner
