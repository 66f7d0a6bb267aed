// SPDX-License-Identifier: BSD-3-Clause
// A person turns a joint of a robot without power. Checks that the configured drive moved, in the
// joint's direction and scale.
#pragma once

#include <string>
#include <vector>

#include "drivers/robot/hardware_config.h"
#include "rt/core/robot_description.h"

namespace sandrunner {

/// Positions of all joints, again and again.
using JointTrace = std::vector<JointArray<double>>;

/// The visible motion when joint `joint` turns in its positive direction out of `pose_rad`, from
/// the robot's links and axes: "LF_FOOT goes backward and down", in directions of the base. It
/// names the part that moves most.
std::string positive_motion(const RobotDescription& robot, const JointArray<double>& pose_rad,
                            int joint);

/// The angle by which the person should turn a joint.
inline constexpr double kAsked_rad = 0.5;

struct HandMove {
  enum class Verdict {
    kGood,
    kNotMoved,    ///< no joint has moved
    kOtherJoint,  ///< another one moved most
    kWrongSign,
    kWrongScale,  ///< by another factor of the requested angle than 2/3 to 3/2
  };
  Verdict verdict = Verdict::kNotMoved;
  int joint = 0;           ///< that moved most
  double moved_rad = 0.0;  ///< that one, from the first to the last position
};

/// Judges a trace in which `joint` was turned by about kAsked_rad in its positive direction.
HandMove judge_move(const JointTrace& trace, int joint);

/// The verdict on joint `joint` as text, with what to look at.
std::string move_words(const HandMove& move, int joint, const HardwareConfig& config,
                       const RobotDescription& robot);

}  // namespace sandrunner
