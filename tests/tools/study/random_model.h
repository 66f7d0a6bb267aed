// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "policy/policy_file.h"
#include "tools/train/model/task_network.h"
#include "tools/train/task/robot_settings.h"

namespace sandrunner {

/// Writes a network for Raibo with random weights, wired like this, and the usual settings of a
/// training.
inline void write_random_model(const std::string& path, const std::string& actor,
                               const std::string& encoder = "lstm") {
  ConfigTree settings;
  train::add_training_layers(settings, sim::load_raibo());
  train::read_task_config(settings);
  PolicyFile file = parse_policy_file(shipped_policy_text(), "the shipped policy");
  file.spec.provenance = {{"config", settings.effective()}};
  const learner::ParameterLayout layout =
      train::model_layout({parse_encoder("encoder", encoder), parse_actor_inputs("actor", actor)});
  learner::to_policy(layout, learner::initial_parameters(layout, 1, 0.5), file.parameters);
  file.golden = make_golden_example(file.parameters);
  write_policy_file(path, file);
}

}  // namespace sandrunner
