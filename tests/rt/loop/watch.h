// SPDX-License-Identifier: BSD-3-Clause
// What becomes of a robot with a defect.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "disturbed_loop.h"

namespace sandrunner {

/// Angle between the body's and the world's z axis.
inline double tilt_rad(const RobotTruth& truth) {
  return std::acos(std::clamp(body_axes(truth.orientation_wxyz)[2][2], -1.0, 1.0));
}
inline double degrees(double rad) { return rad * 180.0 / std::numbers::pi; }

/// What became of a robot.
struct Outcome {
  Fault fault = Fault::kNone;                 ///< the first one
  double after_s = 0.0;                       ///< until then
  double tilt_rad = 0.0;                      ///< of the body at that moment, or at the end
  double largest_tilt_rad = 0.0;              ///< until the end
  double torque_nm = 0.0, speed_radps = 0.0;  ///< largest of a joint until the end
  double fault_torque_nm = 0.0;               ///< largest of a joint until the fault

  bool fell() const { return degrees(largest_tilt_rad) > 60.0; }
  bool on_its_back() const { return degrees(largest_tilt_rad) > 90.0; }
};

/// Runs for `duration_s`, or until `after_fault_s` after a fault.
inline Outcome watch(DisturbedLoop& loop, double duration_s, double after_fault_s = 2.0) {
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
    left = ticks_from_s(after_fault_s) + 1;
  }
  return seen;
}

}  // namespace sandrunner
