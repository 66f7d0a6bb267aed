// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "rt/core/log_histogram.h"
#include "rt/core/robot_description.h"
#include "rt/loop/tick_record.h"
#include "rt/telemetry/ros_messages.h"

namespace sandrunner {

/// The robot's condition: mode, faults and their joints, the gate's counters, the control thread's
/// times since the start. The level is error while a fault is latched, else warning if slots were
/// missed since the last message.
class Diagnostics {
 public:
  /// `robot`: its name, and those of the joints that a fault is about.
  explicit Diagnostics(const RobotDescription& robot);

  void add(const TickRecord& tick) noexcept;
  /// `stamp_ns` since 1970.
  DiagnosticsMessage message(std::int64_t stamp_ns);

 private:
  const std::string hardware_id_;
  const JointArray<std::string> joint_names_;
  Mode mode_ = Mode::kPassive;
  std::uint64_t faults_ = 0, warnings_ = 0, fault_joints_ = 0, tick_ = 0, ticks_ = 0, skipped_ = 0,
                skipped_before_ = 0;
  GateCounters counters_;
  LogHistogram late_, read_, control_, write_;
};

/// "raibo@robot7": this robot, and the computer that it runs on.
std::string hardware_id(const RobotDescription& robot);

/// "none", or the names of the latched faults, separated by ", ".
std::string fault_names(std::uint64_t faults);

}  // namespace sandrunner
