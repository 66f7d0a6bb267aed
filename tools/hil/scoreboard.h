// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rt/core/messages.h"

namespace sandrunner::hil {

/// One drive at one moment.
struct DriveMoment {
  bool on = false, off = true;  ///< neither: it timed out, or has a fault
  bool reachable = true;        ///< it receives its host
  bool passive = true;          ///< it has neither a stiffness nor a torque of its own
  bool limp = true;             ///< it gives no torque at all
  double kp_nmprad = 0.0;       ///< of its last command
  double torque_nm = 0.0;
};

/// A place on the level, m.
struct Place {
  double x_m = 0.0, y_m = 0.0;
};

/// What the drives did after a fault was made.
struct FaultFigures {
  std::string text;
  double made_at_s = 0.0;
  std::optional<double> damped_after_s;   ///< until all reachable drives were passive ...
  std::optional<double> passive_after_s;  ///< ... until all drives were
  std::optional<double> limp_after_s;     ///< until none gave any torque
  double largest_torque_nm = 0.0;         ///< of a joint, from the fault to limp
};

/// What became of the robot, whatever its link.
struct Score {
  std::optional<double> enabled_at_s;  ///< when all drives were first on together
  bool off_at_end = true;              ///< all drives were
  bool base_touched = false;           ///< the ground, while it walked
  double distance_m = 0.0;             ///< from where it lay, level
  double walked_s = 0.0;               ///< with the policy's gains
  /// Over the second half of the walk. None: no walk was seen, as in torque mode, where drives get
  /// no gains.
  std::optional<double> mean_speed_mps;
  std::vector<FaultFigures> faults;

  /// Why there is no mean speed; null: there is one.
  const char* why_no_speed() const noexcept;
};

/// Watches the drives and the base of the emulated robot, once a cycle.
class Scoreboard {
 public:
  /// `walk_s`: length of the walk whose speed is measured; 0: all of it. `walk_kp_nmprad`: the
  /// policy's gain, by which a walk is seen. `lay`: where the robot lies.
  Scoreboard(double cycle_s, double walk_s, double walk_kp_nmprad, Place lay);

  void fault_made(const std::string& text, double now_s);
  void note(double now_s, const JointArray<DriveMoment>& drives, Place base, bool base_contact);

  const std::optional<double>& enabled_at_s() const noexcept { return score_.enabled_at_s; }
  Score score() const;

 private:
  const double cycle_s_, walk_s_, walk_kp_nmprad_;
  const Place lay_;
  Place base_;
  std::vector<Place> walk_;
  Score score_;
};

}  // namespace sandrunner::hil
