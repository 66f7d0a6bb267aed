// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "rt/base/config_tree.h"
#include "sim/robot/robot_model.h"
#include "tools/train/task/task_config.h"

namespace sandrunner::train {

/// The settings that depend on the robot and its sensors, as TOML: those that are good for Raibo,
/// scaled by what the robot's own file says. A leg of other length is the same in its own units of
/// length and time (Froude): commanded speeds go as the root of the height; torques are penalised
/// as shares of weight times height, power of weight times speed. Times of the gait and widths of
/// kernels stay as they are.
std::string robot_settings(const sim::Robot& robot);

/// Throws InputError for a robot that cannot be trained with these settings: gains beyond its
/// limits; joints that turn differently, but for HAA on the right; a nominal pose that is not its
/// own mirror image.
void check_robot(const TaskConfig& config, const sim::Robot& robot);

/// The settings of a training of `robot`, from the weakest layer up: training.toml, what is derived
/// from the robot, and what has been found better for a robot of this name (tools/train/go2.toml).
void add_training_layers(ConfigTree& config, const sim::Robot& robot);

/// What `sandrunner-train` takes for this robot without settings of one's own.
TaskConfig shipped_task_config(const sim::Robot& robot);

/// The same training with one robot, that of the file, on ground that is not chosen by the number
/// of the environment, without pushes and without an end but a fall.
TaskConfig without_variety(TaskConfig config);

}  // namespace sandrunner::train
