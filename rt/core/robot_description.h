// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>

#include "rt/core/messages.h"

namespace sandrunner {

/// What telemetry, files and pictures call a robot, as its file has it.
struct RobotDescription {
  std::string name;                             ///< "raibo"
  std::string base_link;                        ///< "base", as in the URDF
  std::array<std::string, kNumLegs> leg_names;  ///< left front, right front, left hind, right hind
  JointArray<std::string> joint_names;          ///< as in the URDF, in the order of messages.h
  std::string urdf;                             ///< the URDF's text, as read
};

}  // namespace sandrunner
