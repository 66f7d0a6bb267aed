// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "policy/policy_file.h"
#include "tools/train/model/model_file.h"
#include "tools/train/task/robot_settings.h"

namespace sandrunner {

/// Writes a study model for Raibo with random weights and the usual settings of a training but for
/// these, `network.actor` and `network.encoder`.
inline void write_random_model(const std::string& path, const std::string& actor,
                               const std::string& encoder = "lstm") {
  ConfigTree settings;
  train::add_training_layers(settings, sim::load_raibo());
  train::read_task_config(settings);
  const PolicyFile policy = parse_policy_file(shipped_policy_text(), "the shipped policy");
  train::StudyModelFile file;
  file.spec = policy.spec;
  file.spec.provenance = {{"config", settings.effective() + "network.encoder = \"" + encoder +
                                         "\"\nnetwork.actor = \"" + actor + "\"\n"}};
  file.sizes.encoder = learner::parse_encoder("encoder", encoder);
  file.sizes.actor_sees = learner::parse_actor_inputs("actor", actor);
  file.scales = {policy.parameters.observation_mean, policy.parameters.observation_variance,
                 policy.parameters.observation_clip};
  file.parameters = learner::initial_parameters(train::model_layout(file.sizes), 1, 0.5);
  train::write_study_model(path, file);
}

}  // namespace sandrunner
