// SPDX-License-Identifier: BSD-3-Clause
// The yardstick: the same robot in MuJoCo, standing on a plane on its four feet.
#pragma once

#include <string>

#include "sim/robot/robot_model.h"
#include "tools/bench/mujoco/mujoco_robot.h"

namespace sandrunner::bench {

/// MuJoCo's solver settings that are measured.
enum class MujocoSolver {
  kDefault,  ///< Newton, pyramidal cone
  kFastest,  ///< PGS, elliptic cone, one iteration: the fastest of those tried
};

class StandingMujoco {
 public:
  StandingMujoco(const sim::Robot& robot, MujocoSolver solver);

  /// `steps` times the joint torques of a PD law (nominal pose) and mj_step.
  void advance(int steps);

  /// Contacts a step, mean over all steps.
  double mean_contacts() const { return contacts_ / steps_; }
  /// Height of the base, m.
  double height_m() const { return robot_.state().position.z; }
  /// Version and settings in one line, as MuJoCo itself holds them.
  std::string description() const;

 private:
  MujocoRobot robot_;
  JointArray<double> nominal_rad_;
  double contacts_ = 0.0, steps_ = 0.0;
};

}  // namespace sandrunner::bench
