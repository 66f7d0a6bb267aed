// SPDX-License-Identifier: BSD-3-Clause
// The training's task without what it draws at random, apart from commands and starts.
#pragma once

#include "sim/robot/robot_model.h"
#include "tools/train/task/task_config.h"

namespace sandrunner::study {

/// A grid's ground: its two stiffnesses.
struct GridCell {
  double sigma_flat_npm3 = 0.0, sigma_cone_npm3 = 0.0;
};

/// The shipped training's settings with the nominal robot, no delay, no sensor noise, no pushes and
/// no hard ground or patches. Episodes end with a fall alone.
train::TaskConfig plain_task(const sim::Robot& robot);

/// That on soil of this stiffness, all else as in `sim::GroundParameters`, with commands that do
/// not change and are not ramped: up to 3 m/s, sideways and yaw as in a training, and none to stand
/// or to turn on the spot.
train::TaskConfig grid_task(const sim::Robot& robot, const GridCell& cell);

/// Depth of a foot under a quarter of the robot's weight, m.
double static_depth_m(const sim::Robot& robot, const GridCell& cell);

}  // namespace sandrunner::study
