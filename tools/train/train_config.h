// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "rt/base/config_tree.h"
#include "tools/train/battery.h"
#include "tools/train/learner/learner.h"
#include "tools/train/penalty_gate.h"
#include "tools/train/task/task_config.h"

namespace sandrunner::train {

/// Table `run` of tools/train/training.toml.
struct RunSettings {
  int envs = 0;                        ///< environments
  double transitions = 0;              ///< of all environments together, when the training ends
  double checkpoint_interval_s = 0;    ///< least time between checkpoints
  double settle_share = 0;             ///< last share, 0 to 1, in which updates become smaller
  double settle_kl_share = 0;          ///< KL target at the end, over that before; 0 to 1
  double settle_action_std = 0;        ///< most noise of the actions at the end
  double settle_soft_reset_share = 0;  ///< EpisodeSettings::soft_reset_share at the end
};

/// All settings of a training.
struct TrainConfig {
  RunSettings run;
  BatterySettings battery;
  GateSettings gate;
  int window = 0;  ///< policy steps of 10 ms between updates
  learner::LearnerConfig learner;
  TaskConfig task;
  std::string teacher;    ///< file of the networks that the policy imitates; empty: none
  std::string effective;  ///< TOML of all values, for the policy's provenance
};

/// Reads all tables; a missing, unknown or impossible value throws InputError.
TrainConfig read_train_config(ConfigTree& config);

}  // namespace sandrunner::train
