// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "rt/run/process_config.h"
#include "rt/telemetry/dds/telemetry.h"

namespace sandrunner {

/// The process on DDS: telemetry, and, if operators are to command the robot, their inbox.
class DdsBridge {
 public:
  /// `live`: commands come over DDS, and the robot stays passive until somebody asks. `lockstep`:
  /// time is simulated; add() then waits for the wall clock. Throws InputError.
  DdsBridge(const ProcessConfig& config, bool live, bool lockstep = false)
      : participant_(config.dds), operator_(config.dds.stale_ticks()) {
    if (live) {
      inbox_ = std::make_unique<CommandInbox>(
          participant_, config.dds, hardware_id(config.robot.description), true, operator_);
    }
    telemetry_ = std::make_unique<Telemetry>(participant_, config.dds, config.robot.description,
                                             inbox_.get(), lockstep);
    participant_.announce_node("sandrunner");
  }

  void begin(std::int64_t start_time_ns) noexcept { telemetry_->begin(start_time_ns); }
  /// Every tick, in order, from one ordinary thread.
  void add(const TickRecord& tick) { telemetry_->add(tick); }
  /// For the control thread; null if commands come from elsewhere.
  OperatorInput* op() noexcept { return inbox_ ? &operator_ : nullptr; }

 private:
  DdsParticipant participant_;
  DdsOperator operator_;
  std::unique_ptr<CommandInbox> inbox_;
  std::unique_ptr<Telemetry> telemetry_;
};

}  // namespace sandrunner
