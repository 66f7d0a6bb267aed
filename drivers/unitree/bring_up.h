// SPDX-License-Identifier: BSD-3-Clause
// Whether a robot is as it has to be before a controller commands it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "drivers/unitree/robot_link.h"
#include "drivers/unitree/unitree_config.h"
#include "rt/core/gate_config.h"
#include "rt/core/robot_description.h"

namespace sandrunner::unitree {

/// The figures of a robot that a start needs.
struct RobotFigures {
  JointArray<std::string> joint_names;
  JointArray<double> lower_rad{}, upper_rad{};  ///< stops
  JointArray<double> lying_rad{};
  LegJoints<double> damping_kd_nmsprad{};  ///< of the wire's own damping
};

RobotFigures figures_of(const RobotDescription& robot, const GateConfig& gate,
                        const LegJoints<double>& damping_kd_nmsprad);

/// What the states themselves say.
struct StateFigures {
  RobotState state;
  StateCounters counters;
  double rate_hz = 0.0, longest_gap_s = 0.0, tick_rate_hz = 0.0;
};

/// How long to listen to states after the first, and to wait for the first, s.
inline constexpr double kListen_s = 0.5, kFirstState_s = 3.0;

/// Listens to states, for kListen_s since the first one. No state: `counters.taken` is 0. Ends
/// early where `may_go_on` is false.
StateFigures listen_to_states(
    RobotLink& link, const std::function<bool()>& may_go_on = [] { return true; });

/// A line for each thing that is wrong with the states; none: all is well.
std::vector<std::string> state_problems(const UnitreeConfig& config, const RobotFigures& robot,
                                        const StateFigures& figures, bool wrong_type);

/// Whether the robot's knees are folded, as those of one that lies are.
bool lies(const RobotFigures& robot, const RobotState& state) noexcept;

/// Prepares the robot for commands: looks at its states, switches its own controller off, listens
/// for other programs, finds who reads commands. Sends none itself. Seconds. Throws InputError, one
/// line. It calls `may_go_on` now and then, and ends where that is false.
void bring_up(RobotLink& link, const UnitreeConfig& config, const RobotFigures& robot,
              const std::function<bool()>& may_go_on);

}  // namespace sandrunner::unitree
