// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rt/core/messages.h"
#include "rt/core/robot_description.h"

namespace sandrunner::hil {

/// What the drives did after a fault was made.
struct FaultFigures {
  std::string text;
  /// Until no drive that still hears its host had a stiffness or a torque of its own ...
  std::optional<double> damped_after_s;
  std::optional<double> passive_after_s;  ///< ... until no drive at all had
  std::optional<double> limp_after_s;     ///< until none gave any torque
  double largest_torque_nm = 0.0;         ///< of a joint, from the fault to limp
};

struct DriveFigures {
  std::uint64_t frames = 0, replies = 0, time_outs = 0;
  double longest_gap_s = 0.0;  ///< between two commands while it was on
  const char* state = "";      ///< at the end: off, on, timed out, fault
  bool off = true;
};

/// What the bench saw.
struct BenchReport {
  double time_s = 0.0;
  bool was_enabled = false;   ///< all drives were on at a time
  bool base_touched = false;  ///< the ground, while it walked
  double distance_m = 0.0;    ///< from where it lay, level
  double walked_s = 0.0;      ///< with the policy's gains
  /// Over the second half of the walk; none in torque mode, where no drive is told gains.
  std::optional<double> mean_speed_mps;
  JointArray<DriveFigures> drives;
  std::vector<FaultFigures> faults;
  std::uint64_t imu_packets = 0, imu_not_taken = 0;
  double answer_mean_us = 0.0, answer_longest_us = 0.0;  ///< from the kernel's receipt to sent
  double late_longest_us = 0.0;                          ///< end of a tick after its slot
  bool all_off() const noexcept;
};

std::string report_json(const BenchReport& report, const RobotDescription& robot);
std::string report_lines(const BenchReport& report, const RobotDescription& robot);

}  // namespace sandrunner::hil
