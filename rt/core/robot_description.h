// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

#include "rt/core/messages.h"

namespace sandrunner {

/// A link of the robot: where it is in the frame of another one.
struct RobotFrame {
  std::string name, parent;
  Vector3 translation_m{};
  std::array<double, 4> rotation_wxyz{1.0, 0.0, 0.0, 0.0};  ///< with its joint at zero
  int joint = -1;                                           ///< that turns it; -1: it is fixed
  Vector3 axis{};  ///< of that joint, unit vector in the link's own frame
};

/// A ball of the robot's outline: with one of them it touches level ground.
struct OutlinePoint {
  std::string frame;
  Vector3 centre_m{};
  double radius_m = 0.0;
};

/// What telemetry, files and pictures call a robot, as its file has it.
struct RobotDescription {
  std::string name;                             ///< "raibo"
  std::array<std::string, kNumLegs> leg_names;  ///< left front, right front, left hind, right hind
  JointArray<std::string> joint_names;          ///< as in the URDF, in the order of messages.h
  std::string urdf;                             ///< the URDF's text, as read

  // For ROS 2 and its tools (sim/robot/ros_description.h):
  std::string base_frame;  ///< "base_link"; frame of the base, in which velocities are measured
  std::string ros_urdf;    ///< the URDF with a base_link, and with something to see
  std::vector<RobotFrame> frames;     ///< all links but `base_frame`, each after its parent
  std::vector<OutlinePoint> outline;  ///< feet, knees, corners of the base
};

}  // namespace sandrunner
