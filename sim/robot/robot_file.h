// SPDX-License-Identifier: BSD-3-Clause
// A robot's file (TOML): its rows, and what it says of the URDF's parts.
#pragma once

#include <array>
#include <limits>
#include <string>

#include "rt/core/messages.h"
#include "sim/robot/robot_model.h"

namespace sandrunner::sim {

/// In place of a figure: the URDF's counts.
inline constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// What a robot's file says that is no figure of `Robot` as it stands there. {leg} in the name of a
/// joint or link stands for a leg's name.
struct RobotFile {
  std::string source;  ///< name of the file, for errors
  std::string name, urdf;
  std::string left_front, right_front, left_hind, right_hind;
  std::string haa, hfe, kfe;
  std::string base, hip, thigh, shank, foot;
  LegJoints<double> rotor_inertia_kgm2{}, friction_nm{};
  LegJoints<double> lower_rad{kNone, kNone, kNone}, upper_rad{kNone, kNone, kNone};
  LegJoints<double> torque_limit_nm{kNone, kNone, kNone}, speed_limit_radps{kNone, kNone, kNone};
  double foot_radius_m = 0.0;
  int foot_patches = 0;  ///< 0: as the shape has them
  std::array<double, 3> base_box_m{}, base_box_centre_m{};

  /// Names of LF, RF, LH, RH.
  std::array<std::string, kNumLegs> legs() const {
    return {left_front, right_front, left_hind, right_hind};
  }
  /// Whether it has a box of its own in place of the URDF's.
  bool has_base_box() const { return base_box_m != std::array<double, 3>{}; }
  /// Throws InputError.
  [[noreturn]] void fail(const std::string& what) const;
};

/// Reads a robot's file; its figures go into `robot`, the nominal height as 0 where the geometry is
/// to give it. Every required row must be there: a robot has no figures by default. Throws
/// InputError.
RobotFile read_robot_file(const std::string& text, const std::string& source, Robot& robot);

/// Its row `urdf` alone. Throws InputError.
std::string urdf_in_robot_file(const std::string& text, const std::string& source);

/// The figures of one leg for all of them.
inline JointArray<double> all_legs(const LegJoints<double>& leg) {
  JointArray<double> all;
  for (int j = 0; j < kNumJoints; ++j) all[j] = leg[j % kJointsPerLeg];
  return all;
}

}  // namespace sandrunner::sim
