// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>

#include "rt/core/messages.h"
#include "sim/robot/robot_model.h"
#include "sim/robot/urdf_reader.h"

namespace sandrunner::sim {

/// Links of a leg, by name.
struct LegLinks {
  std::string hip, thigh, shank, foot;
  Vector3 foot_centre_m{};  ///< of its shape, in the frame of `foot`
};

/// Fills in what ROS 2's tools need of a robot: `base_frame`, `frames`, `outline` and `ros_urdf` of
/// its description; the rest of it and the model are there already.
///
/// The base's frame is "base_link", as REP 105 has it: the base itself if it is called that, or a
/// link of that name at the same place from which the base hangs, or a new root above the base.
/// Where the URDF leaves none of these, it is the base under its own name.
///
/// A URDF without any <visual> gets some: its collision shapes, and rods along the limbs that have
/// none.
void describe_for_ros(const UrdfReader& urdf, const std::string& base,
                      const std::array<LegLinks, kNumLegs>& legs, Robot& robot);

}  // namespace sandrunner::sim
