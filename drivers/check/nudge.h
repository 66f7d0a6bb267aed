// SPDX-License-Identifier: BSD-3-Clause
// A drive pushes its own joint a little, the robot hanging. Checks the sign and scale of its
// torque. This is the robot's first powered motion, so no drive is trusted before it passed: a
// drive with the wrong sign would push where it should damp.
//
// Example: tests/drivers/check/nudge_test.cpp.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "drivers/robot/drive.h"
#include "drivers/robot/hardware_config.h"

namespace sandrunner {

/// The newest state of all drives.
struct NudgeState {
  double time_s = 0.0;
  JointArray<double> position_rad{}, velocity_radps{}, torque_nm{};
  JointArray<bool> well{};  ///< the drive answers and reports no fault
  bool stop = false;        ///< the person asks to stop
};

/// The setpoints of one exchange; a drive without one gets an off frame.
using NudgePoints = JointArray<std::optional<SetPoint>>;
/// Makes one exchange, every few milliseconds.
using NudgeExchange = std::function<NudgeState(const NudgePoints&)>;

inline constexpr double kNudge_nm = 2.0;
/// A push ends at once when any joint is this fast, or the pushed one has moved this far. Then the
/// pushed joint's own drive brakes it, if it pushed the right way; beyond kNudgeFarthest it is off.
inline constexpr double kNudgeFastest_radps = 3.0, kNudgeEnough_rad = 0.1;
inline constexpr double kNudgeFarthest_rad = 0.3;

struct Nudge {
  enum class Verdict {
    kGood,
    kNotMoved,     ///< no joint has moved: a stop may be in the way
    kOtherJoint,   ///< another one has moved
    kWrongSign,    ///< it moved against the torque
    kWrongSpeed,   ///< its velocity is not the change of its position
    kWrongTorque,  ///< it reports another torque than the commanded one
    kNotStill,     ///< joint `other` did not come to rest: nothing was pushed
    kNotWell,      ///< drive `other` reported a fault, or fell silent
    kStopped,      ///< by the person
  };
  Verdict verdict = Verdict::kNotMoved;
  int other = 0;               ///< the joint that moved most, or see above
  double asked_nm = 0.0;       ///< with a sign
  double reported_nm = 0.0;    ///< mean
  double moved_rad = 0.0;      ///< by position
  double travelled_rad = 0.0;  ///< by velocity
  double pushed_s = 0.0;
};

/// Pushes joint `joint` by `torque_nm` once all joints have been at rest for a second. Joints
/// `damped` are damped by their drives, the others are off; so is the pushed one in the end. The
/// last exchange takes the torque away.
Nudge nudge(int joint, double torque_nm, const JointArray<bool>& damped,
            const NudgeExchange& exchange);

/// The verdict on joint `joint` as text, with what to look at.
std::string nudge_words(const Nudge& nudge, int joint, const HardwareConfig& config,
                        const RobotDescription& robot);

}  // namespace sandrunner
