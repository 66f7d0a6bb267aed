// SPDX-License-Identifier: BSD-3-Clause
// A second robot, of the tests' own making (tests/support/small_robot/): half of Raibo's mass,
// three quarters of its lengths, other names, poses, gains and limits, ball feet. What works with
// it has no figure of Raibo's.
#pragma once

#include <string>

#include "tests/support/temporary_folder.h"

namespace sandrunner {

inline std::string small_robot_file(const std::string& name) {
  return read_file(SANDRUNNER_GOLDEN_DIR "/../support/small_robot/" + name);
}

inline std::string small_robot_urdf() { return small_robot_file("small.urdf"); }

/// Writes small.toml and small.urdf into `folder`; returns the path of the map.
inline std::string write_small_robot(const TemporaryFolder& folder) {
  write_file(folder.path("small.urdf"), small_robot_urdf());
  write_file(folder.path("small.toml"), small_robot_file("small.toml"));
  return folder.path("small.toml");
}

}  // namespace sandrunner
