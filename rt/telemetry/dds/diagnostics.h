// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "rt/core/log_histogram.h"
#include "rt/core/robot_description.h"
#include "rt/loop/tick_record.h"
#include "rt/telemetry/dds/command_inbox.h"
#include "rt/telemetry/dds/participant.h"

namespace sandrunner {

/// Publishes the robot's condition on rt/diagnostics: mode, faults and their joints, the gate's
/// counters, the control thread's times since the start, what became of commands and messages. The
/// level is error while a fault is latched, else warning if slots were missed since the last
/// message.
class Diagnostics {
 public:
  /// `robot`: names of the joints that a fault is about. Throws InputError.
  Diagnostics(const DdsParticipant& participant, const RobotDescription& robot);

  void add(const TickRecord& tick) noexcept;
  /// `stamp_ns` since 1970; `failed_writes`: of all topics so far. False: could not be written.
  bool publish(std::int64_t stamp_ns, const CommandCounts& commands, std::uint64_t failed_writes);

 private:
  using Values = std::vector<std::pair<std::string, std::string>>;
  Values values(const CommandCounts& commands, std::uint64_t failed_writes) const;

  dds_entity_t writer_;
  const JointArray<std::string> joint_names_;
  Mode mode_ = Mode::kPassive;
  std::uint64_t faults_ = 0, fault_joints_ = 0, tick_ = 0, ticks_ = 0, skipped_ = 0,
                skipped_before_ = 0;
  GateCounters counters_;
  LogHistogram late_, read_, control_, write_;
};

/// "none", or the names of the latched faults, separated by ", ".
std::string fault_names(std::uint64_t faults);

}  // namespace sandrunner
