// SPDX-License-Identifier: BSD-3-Clause
// The tables that campaigns print of what became of a robot with a defect.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string>

#include "attack_loop.h"
#include "tests/rt/loop/watch.h"

namespace sandrunner::attack {

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
