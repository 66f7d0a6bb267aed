// SPDX-License-Identifier: BSD-3-Clause
// A first robot file for a URDF.
#pragma once

#include <string>
#include <vector>

namespace sandrunner::sim {

struct NewRobot {
  std::string file;                  ///< text of the robot file
  std::vector<std::string> guesses;  ///< its keys that the URDF does not say
};

/// Finds legs, links and feet in a URDF, and derives poses, gains and limits from it. `urdf_name`:
/// of the text, for errors; `urdf_path`: as the robot file is to name it. Throws InputError if the
/// URDF has no four legs of three joints.
NewRobot new_robot(const std::string& urdf_text, const std::string& urdf_name,
                   const std::string& urdf_path);

}  // namespace sandrunner::sim
