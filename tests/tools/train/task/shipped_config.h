// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rt/base/config_tree.h"
#include "tools/train/task/robot_settings.h"
#include "tools/train/task/task_config.h"

namespace sandrunner::train {

/// What `sandrunner-train` takes for this robot without settings of one's own.
inline TaskConfig shipped_task_config(const sim::Robot& robot) {
  ConfigTree tree;
  add_training_layers(tree, robot);
  return read_task_config(tree);
}

}  // namespace sandrunner::train
