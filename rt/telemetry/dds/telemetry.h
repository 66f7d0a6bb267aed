// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "estimator/odometry.h"
#include "rt/core/robot_description.h"
#include "rt/core/slower_rate.h"
#include "rt/loop/clock.h"
#include "rt/loop/tick_record.h"
#include "rt/operator/operator_desk.h"
#include "rt/telemetry/dds/dds_config.h"
#include "rt/telemetry/dds/neighbours.h"
#include "rt/telemetry/dds/ros_publisher.h"
#include "rt/telemetry/dds/tick_batches.h"
#include "rt/telemetry/diagnostics.h"

namespace sandrunner {

/// Publishes what the control loop does: ROS 2's messages at `ros_hz`, diagnostics once a second,
/// and every tick in batches. Used by one thread of ordinary priority; a write may take
/// milliseconds. A stamp is the wall clock at tick 0 plus 0.25 ms per tick: stamps are as evenly
/// spaced as the control loop's slots and do not follow later corrections of the wall clock.
///
/// In lockstep, that time goes out on rt/clock before the messages that are stamped with it, and
/// add() waits so that it never runs ahead of the wall clock.
class Telemetry {
 public:
  /// `participant` must outlive this object, and so must `desk`, whose counts are published; it
  /// may be null. Throws InputError.
  Telemetry(const DdsParticipant& participant, const DdsConfig& config,
            const RobotDescription& robot, const OperatorDesk* desk, RunClock clock);
  /// Publishes the last ticks.
  ~Telemetry();
  Telemetry(const Telemetry&) = delete;
  Telemetry& operator=(const Telemetry&) = delete;

  /// The wall clock at tick 0, ns since 1970; before the first add().
  void begin(std::int64_t start_ns) noexcept;
  /// Every tick, in order.
  void add(const TickRecord& tick);

  /// Messages that could not be written.
  std::uint64_t failed_writes() const noexcept { return failed_writes_; }

 private:
  void add_neighbours(DiagnosticsMessage& message);

  SlowerRate ros_rate_;
  SlowerRate batch_rate_{kControlHz / kTicksPerBatch}, diagnostics_rate_{1};
  const OperatorDesk* desk_;
  RosPublisher ros_;
  std::optional<ClockPublisher> clock_;  // in lockstep
  NeighbourWatch neighbours_;
  Diagnostics diagnostics_;
  std::optional<TickBatches> batches_;
  Odometry odometry_;
  std::int64_t start_ns_ = 0;
  std::chrono::steady_clock::time_point start_;
  std::uint64_t failed_writes_ = 0;
  bool alone_ = true;  // no other robot has been seen
};

}  // namespace sandrunner
