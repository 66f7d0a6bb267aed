// SPDX-License-Identifier: BSD-3-Clause
// sandbox_policies FOLDER: writes tcn.safetensors and perceptron.safetensors, policies for Raibo
// with the networks that no shipped policy has. The former falls, the latter stands.
#include <string>

#include "policy/policy_file.h"
#include "policy/safetensors.h"
#include "tests/policy/random_perceptron.h"

namespace sandrunner {
namespace {

void write_policies(const std::string& folder) {
  PolicyFile tcn = random_policy_file(1, {EncoderKind::kTcn, {}});
  PerceptronFile perceptron = random_perceptron(
      "command, angular_velocity, gravity, joint_position, joint_velocity, last_action, phase "
      "period 0.8",
      6, HistoryOrder::kNewestFirst, Activation::kElu, {128, 64, 19}, {512, 256, 128});
  tcn.spec = perceptron.spec = load_shipped_policy().spec();
  perceptron.spec.action_scale_rad.fill(0.01);
  perceptron.spec.action_clip = 1.0;
  write_policy_file(folder + "/tcn.safetensors", tcn);
  const std::string path = folder + "/perceptron.safetensors";
  write_safetensors(path, encode_perceptron(path, perceptron));
}

}  // namespace
}  // namespace sandrunner

int main(int, char** argv) { sandrunner::write_policies(argv[1]); }
