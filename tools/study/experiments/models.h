// SPDX-License-Identifier: BSD-3-Clause
// The trained controllers of a study: files NAME-SEED.safetensors of one folder.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "policy/policy.h"
#include "sim/robot/robot_model.h"
#include "tools/study/experiments/controllers.h"
#include "tools/train/model/task_network.h"

namespace sandrunner::study {

struct Model {
  const Controller* controller;
  int seed;
  std::uint64_t hash;          ///< of its file
  train::TaskNetwork network;  ///< as the training's environments run it
  /// As the runner of sandrunner-evaluate runs it; none of a controller that sees the ground.
  std::optional<Policy> policy;
};

/// "ours-1"
std::string model_name(const Model& model);

/// 64 bits that change with any byte: to find out whether a file is the same.
std::uint64_t hash_of(std::string_view bytes);

/// The models of `folder` with these seeds (none: all seeds), by controller, then seed. Throws
/// InputError if there is none, if a file's name is not that of a controller with a seed, if a file
/// is no policy file of a training of `robot`, or if its networks are not wired
/// as those of its controller.
std::vector<Model> load_models(const std::string& folder, const std::vector<int>& seeds,
                               const sim::Robot& robot);

/// The authors' network, seed 0, from a policy file that `sandrunner-policy import` made. Its
/// inputs are scaled otherwise than those of a training, so no Task can run it. Throws InputError.
Model load_published(const std::string& path, const sim::Robot& robot);

}  // namespace sandrunner::study
