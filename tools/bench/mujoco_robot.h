// SPDX-License-Identifier: BSD-3-Clause
// The yardstick: the same robot in MuJoCo, standing on a plane on its four feet.
#pragma once

#include <memory>
#include <string>

#include "sim/robot/robot_model.h"

namespace sandrunner::bench {

/// MuJoCo's solver settings that are measured.
enum class MujocoSolver {
  kDefault,  ///< Newton, pyramidal cone
  kFastest,  ///< PGS, elliptic cone, one iteration: the fastest of those tried
};

class MujocoRobot {
 public:
  MujocoRobot(const sim::Robot& robot, MujocoSolver solver);
  ~MujocoRobot();
  MujocoRobot(const MujocoRobot&) = delete;
  MujocoRobot& operator=(const MujocoRobot&) = delete;

  /// `steps` times the joint torques of a PD law (nominal pose) and mj_step.
  void advance(int steps);

  /// Contacts a step, mean over all steps.
  double mean_contacts() const;
  /// Height of the base, m.
  double height_m() const;
  /// Version and settings in one line, as MuJoCo itself holds them.
  std::string description() const;

 private:
  struct Simulation;
  std::unique_ptr<Simulation> simulation_;
};

}  // namespace sandrunner::bench
