// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "rt/loop/tick_sink.h"
#include "rt/run/process_config.h"
#include "rt/telemetry/dds/command_inbox.h"
#include "rt/telemetry/dds/ros_node.h"
#include "rt/telemetry/dds/telemetry.h"

namespace sandrunner {

/// The process on DDS: telemetry, and, if operators are to command the robot, their inbox.
class DdsBridge final : public TickSink {
 public:
  /// `desk`: takes commands that come over DDS; null: none do. In lockstep add() waits for the
  /// wall clock. Throws InputError.
  DdsBridge(const ProcessConfig& config, OperatorDesk* desk, RunClock clock)
      : participant_(config.dds) {
    if (desk) {
      inbox_ = std::make_unique<CommandInbox>(participant_, config.dds,
                                              hardware_id(config.robot.description), *desk);
    }
    telemetry_ = std::make_unique<Telemetry>(participant_, config.dds, config.robot.description,
                                             desk, clock);
    announce_node(participant_, "sandrunner");
  }

  void begin(std::int64_t start_ns) override { telemetry_->begin(start_ns); }
  void add(const TickRecord& tick) override { telemetry_->add(tick); }

 private:
  DdsParticipant participant_;
  std::unique_ptr<CommandInbox> inbox_;
  std::unique_ptr<Telemetry> telemetry_;
};

}  // namespace sandrunner
