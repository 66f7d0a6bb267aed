// SPDX-License-Identifier: BSD-3-Clause
// What becomes of a robot with a defect, and the tables that campaigns print.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string>

#include "attack_loop.h"

namespace sandrunner::attack {

/// What became of a robot.
struct Outcome {
  Fault fault = Fault::kNone;                 ///< the first one
  double after_s = 0.0;                       ///< until then
  double tilt_rad = 0.0;                      ///< of the body at that moment, or at the end
  double largest_tilt_rad = 0.0;              ///< until the end, which is 2 s after a fault
  double torque_nm = 0.0, speed_radps = 0.0;  ///< largest of a joint until the end
  double fault_torque_nm = 0.0;               ///< largest of a joint until the fault

  bool fell() const { return degrees(largest_tilt_rad) > 60.0; }
  bool on_its_back() const { return degrees(largest_tilt_rad) > 90.0; }
};

/// Runs for `duration_s`, or until 2 s after a fault.
inline Outcome watch(AttackLoop& loop, double duration_s) {
  Outcome seen;
  std::uint64_t left = ticks_from_s(duration_s);
  for (std::uint64_t n = 1; left > 0; ++n, --left) {
    loop.step();
    const RobotTruth& truth = loop.truth();
    seen.largest_tilt_rad = std::max(seen.largest_tilt_rad, tilt_rad(truth));
    for (int j = 0; j < kNumJoints; ++j) {
      seen.torque_nm = std::max(seen.torque_nm, std::fabs(truth.joint_torque_nm[j]));
      seen.speed_radps = std::max(seen.speed_radps, std::fabs(truth.joint_velocity_radps[j]));
    }
    if (seen.fault != Fault::kNone) continue;
    seen.tilt_rad = tilt_rad(truth);
    seen.after_s = static_cast<double>(n) * kControlPeriod_s;
    seen.fault_torque_nm = seen.torque_nm;
    if (loop.fault() == Fault::kNone) continue;
    seen.fault = loop.fault();
    left = ticks_from_s(2.0) + 1;
  }
  return seen;
}

/// Whether a campaign is to run the row `name`: all, or those that contain SANDRUNNER_ATTACK_ONLY.
inline bool is_selected(const std::string& name) {
  const char* const only = std::getenv("SANDRUNNER_ATTACK_ONLY");
  return only == nullptr || name.find(only) != std::string::npos;
}

inline void print_outcomes_header() {
  std::printf(
      "| run | end | after s | tilt then | largest tilt | torque to then | torque | fastest "
      "joint |\n|---|---|---|---|---|---|---|---|\n");
}
inline void print_outcome(const std::string& name, const Outcome& seen) {
  std::printf("| %s | %s | %.2f | %.0f | %s%.0f | %.1f | %.1f | %.1f |\n", name.c_str(),
              seen.fault == Fault::kNone ? "no fault" : fault_name(seen.fault), seen.after_s,
              degrees(seen.tilt_rad), seen.fell() ? "FELL " : "", degrees(seen.largest_tilt_rad),
              seen.fault_torque_nm, seen.torque_nm, seen.speed_radps);
  std::fflush(stdout);
}

}  // namespace sandrunner::attack
