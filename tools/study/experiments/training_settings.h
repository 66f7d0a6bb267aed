// SPDX-License-Identifier: BSD-3-Clause
// How a model was trained, from the provenance in its file.
#pragma once

#include <string>
#include <vector>

#include "tools/study/experiments/models.h"

namespace sandrunner::study {

/// A setting of a training.
struct SettingDifference {
  std::string key, value;
  std::string usual;  ///< of tools/train/training.toml for the robot; empty: it has no such key
};

/// `config`: TOML of a training's settings, as the provenance of a policy file has it. Those that
/// differ from the trainer's own for this robot, but for the length of the training.
std::vector<SettingDifference> settings_that_differ(const std::string& config,
                                                    const sim::Robot& robot);

/// Length of its training, in transitions; 0 if its provenance does not say it.
double training_length(const Model& model);

}  // namespace sandrunner::study
