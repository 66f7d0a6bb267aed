// SPDX-License-Identifier: BSD-3-Clause
// How the models were trained, from the provenance in their files.
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

/// Length of the longest training of these, in transitions; 0 if none says it.
double longest_training(const std::vector<Model>& models);

/// Tables of the page: where each model comes from, and the settings of each controller's training
/// that differ.
std::string methods_tables(const std::vector<Model>& models, const sim::Robot& robot);

}  // namespace sandrunner::study
