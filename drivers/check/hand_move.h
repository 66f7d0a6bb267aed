// SPDX-License-Identifier: BSD-3-Clause
// A person turns a joint of a robot without power: is it the drive that the configuration says, and
// does it count in the joint's direction and scale?
#pragma once

#include <string>
#include <vector>

#include "drivers/robot/hardware_config.h"
#include "rt/core/robot_description.h"

namespace sandrunner {

/// Positions of all joints, again and again.
using JointTrace = std::vector<JointArray<double>>;

/// What a person sees when joint `joint` turns in its positive direction out of `pose_rad`, from
/// the robot's links and axes alone: "LF_FOOT goes backward and down", in directions of the base.
/// It is said of the part that moves most.
std::string positive_motion(const RobotDescription& robot, const JointArray<double>& pose_rad,
                            int joint);

/// What the person is asked to turn a joint by.
inline constexpr double kAsked_rad = 0.5;

struct HandMove {
  enum class Verdict {
    kGood,
    kNotMoved,    ///< no joint has moved
    kOtherJoint,  ///< another one has moved most
    kWrongSign,
    kWrongScale,  ///< by more than twice or less than half of what was asked for
  };
  Verdict verdict = Verdict::kNotMoved;
  int joint = 0;           ///< that moved most
  double moved_rad = 0.0;  ///< that one, from the first to the last position
};

/// Judges a trace in which `joint` was turned by about kAsked_rad in its positive direction.
HandMove judge_move(const JointTrace& trace, int joint);

/// The verdict on joint `joint` for a person, with what to look at.
std::string move_words(const HandMove& move, int joint, const HardwareConfig& config,
                       const RobotDescription& robot);

}  // namespace sandrunner
