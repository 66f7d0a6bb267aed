// SPDX-License-Identifier: BSD-3-Clause
// Which parts of a URDF are the legs of a quadruped.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "sim/robot/leg_poses.h"
#include "sim/robot/urdf_reader.h"

namespace sandrunner::sim {

/// Keys of a robot file for the legs, in their order.
inline constexpr const char* kLegKeys[] = {"left_front", "right_front", "left_hind", "right_hind"};

/// Legs in the order LF, RF, LH, RH.
struct UrdfLegs {
  std::string base;  ///< the link that carries them
  /// HAA, HFE, KFE. Of the joints of a reader that is gone: names, types and limits are copies.
  std::array<std::vector<urdf::Joint>, kNumLegs> joints;
  std::array<std::string, kNumLegs> foot;  ///< links
  std::array<LegGeometry, kNumLegs> geometry;
  bool feet_have_shapes = false;
};

/// Finds four legs of three joints by their place. `name` stands for the text in errors. Throws
/// InputError if there are none such.
UrdfLegs find_legs(const std::string& text, const std::string& name);

}  // namespace sandrunner::sim
