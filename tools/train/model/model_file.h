// SPDX-License-Identifier: BSD-3-Clause
// Study models: networks that never run on a robot, as safetensors files. Their metadata are those
// of a policy file, under a format name of their own, so that every program that wants a policy
// refuses them. README.md of this folder defines the format.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "policy/golden.h"
#include "policy/policy.h"
#include "tools/train/learner/parameters.h"
#include "tools/train/task/normalise.h"
#include "tools/train/task/task_config.h"

namespace sandrunner::train {

/// How observations enter: (x - mean) / sqrt(variance + 1e-8), limited to +-clip.
struct ObservationScales {
  std::vector<float> mean, variance;
  float clip = 0.0f;
};

/// Content of a study model.
struct StudyModelFile {
  PolicySpec spec;
  learner::NetworkSizes sizes;  ///< and the wiring
  ObservationScales scales;
  std::vector<float> parameters;  ///< of model_layout(sizes); the actor answers in joints
  GoldenExample golden;
  std::vector<float> golden_insight;  ///< (kGoldenSteps, kInsightSize), if a network sees it
};

/// Encoder, estimator and actor, whose tensors have the same places as in the layout of a training;
/// the critic is a single layer that is not used.
learner::ParameterLayout model_layout(const learner::NetworkSizes& sizes);

/// Takes over encoder, estimator and actor from the parameters of a training, with the actor's
/// modes turned into joints. `mode_gain`: of the training (leg_modes.h).
void set_trained(const std::vector<float>& trained, const std::array<double, kNumLegs>& mode_gain,
                 StudyModelFile& file);

/// Writes the file with a golden run, and checks it as a reader would. Throws InputError.
void write_study_model(const std::string& path, StudyModelFile file);
/// Throws InputError, in one line, if anything is missing, unknown, of the wrong size or out of
/// range, or if the golden run ends elsewhere.
StudyModelFile read_study_model(const std::string& path);
/// Whether the file calls itself a study model. Throws InputError if it is no safetensors file.
bool is_study_model(const std::string& path);

/// A network as a Task runs it: it answers in modes.
struct TaskNetwork {
  PolicySpec spec;
  ObservationScales scales;
  learner::ParameterLayout layout;
  std::vector<float> parameters;
};

/// Of a study model or a policy file. Throws InputError.
TaskNetwork read_task_network(const std::string& path,
                              const std::array<double, kNumLegs>& mode_gain);

/// Throws InputError unless weights of `network`, of a policy or a model with this spec, mean in a
/// Task with these settings and scales what they mean in their own. Nominal positions may differ:
/// angles are shown as what they are off them.
void require_scales(const PolicySpec& spec, const ObservationScales& network,
                    const PolicySettings& task, const InputScales& task_scales);

}  // namespace sandrunner::train
