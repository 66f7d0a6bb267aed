// SPDX-License-Identifier: BSD-3-Clause
// Policy files with a perceptron in place of the network: README.md, "Networks of others".
#pragma once

#include <string>
#include <vector>

#include "policy/perceptron.h"
#include "policy/policy.h"
#include "policy/safetensors.h"

namespace sandrunner {

/// Content of such a file.
struct PerceptronFile {
  PolicySpec spec;
  PerceptronParameters parameters;
  /// Inputs of the network, (kGoldenSteps, inputs), and what it answers, (kGoldenSteps, 12), in its
  /// own order and not limited. Computed from the file that was imported, by other code.
  std::vector<float> golden_observation, golden_action;
};

/// Whether a policy file has a perceptron.
bool is_perceptron(const TensorFile& content);

/// Checks all of it and runs its golden example. Throws InputError as read_policy_file.
PerceptronFile decode_perceptron(const std::string& path, TensorFile content);
/// Checks `file` likewise, then returns what a file has of it.
TensorFile encode_perceptron(const std::string& path, const PerceptronFile& file);

/// Takes weights and golden example of bare tensors, of the names and shapes that `file` asks for;
/// the metadata become the provenance. Throws InputError.
void take_bare_tensors(const std::string& path, TensorFile content, PerceptronFile& file);

/// Largest deviation of an answer in the golden example, relative to max(1, |expected|). Throws
/// InputError if it exceeds kGoldenTolerance.
double check_golden_example(const std::string& path, const PerceptronFile& file);

/// The policy, ready to run.
Policy make_policy(PerceptronFile file);

}  // namespace sandrunner
