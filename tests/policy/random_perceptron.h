// SPDX-License-Identifier: BSD-3-Clause
// A perceptron with random weights, and the same written plainly.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "policy/golden.h"
#include "policy/perceptron_file.h"
#include "tests/policy/random_policy.h"

namespace sandrunner {

using Doubles = std::vector<double>;

struct PlainAnswer {
  Doubles action;  ///< in the network's order
  Doubles velocity_mps;
};

inline Doubles plain_layers(const std::vector<DenseParameters>& layers, Activation activation,
                            Doubles x) {
  for (const DenseParameters& layer : layers) {
    if (&layer != layers.data()) {
      for (double& v : x) {
        const double below = activation == Activation::kElu         ? std::expm1(v)
                             : activation == Activation::kLeakyRelu ? 0.01 * v
                                                                    : 0.0;
        v = activation == Activation::kTanh ? std::tanh(v) : v > 0.0 ? v : below;
      }
    }
    Doubles out(layer.bias.begin(), layer.bias.end());
    for (std::size_t row = 0; row < out.size(); ++row) {
      for (std::size_t j = 0; j < x.size(); ++j) {
        out[row] += static_cast<double>(layer.weight[row * x.size() + j]) * x[j];
      }
    }
    x = out;
  }
  return x;
}

inline PlainAnswer plain_answer(const PerceptronParameters& parameters, const Doubles& input,
                                const Doubles& newest) {
  if (parameters.estimator_layers.empty()) {
    return {plain_layers(parameters.actor_layers, parameters.activation, input), {}};
  }
  const Doubles estimate = plain_layers(parameters.estimator_layers, parameters.activation, input);
  double square = 0.0;
  for (std::size_t i = 3; i < estimate.size(); ++i) square += estimate[i] * estimate[i];
  Doubles seen = newest, velocity;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    seen.push_back(i < 3 ? estimate[i] : estimate[i] / std::sqrt(square));
    if (i < 3) velocity.push_back(estimate[i] / parameters.velocity_scale);
  }
  return {plain_layers(parameters.actor_layers, parameters.activation, seen), velocity};
}

/// With joints in an order of its own and scales that differ.
inline PerceptronFile random_perceptron(const std::string& terms, int history, HistoryOrder order,
                                        Activation activation = Activation::kElu,
                                        const std::vector<int>& estimator = {},
                                        const std::vector<int>& actor = {40, 24}) {
  PerceptronFile file;
  file.spec = random_policy_file().spec;
  PerceptronParameters& p = file.parameters;
  p.observation.terms = parse_terms("terms", terms);
  p.observation.history = history;
  p.observation.order = order;
  p.activation = activation;
  p.estimator = estimator;
  p.actor = actor;
  for (int j = 0; j < kNumJoints; ++j) {
    p.joint_of[j] = 5 * j % kNumJoints;
    file.spec.action_scale_rad[j] = 0.1 + 0.01 * j;
  }
  RandomFloats random(5);
  for (const NamedTensor& tensor : tensors_of("random", p)) {
    const float scale = 1.5f / std::sqrt(static_cast<float>(tensor.shape.back()));
    for (std::size_t i = 0; i < tensor.size(); ++i) tensor.values->push_back(scale * random.next());
  }
  for (int k = 0; k < kGoldenSteps; ++k) {
    Doubles input;
    for (int i = 0; i < p.observation.inputs(); ++i) input.push_back(random.next());
    file.golden_observation.insert(file.golden_observation.end(), input.begin(), input.end());
    const PlainAnswer answer =
        plain_answer(p, input, Doubles(input.begin(), input.begin() + p.observation.numbers()));
    file.golden_action.insert(file.golden_action.end(), answer.action.begin(), answer.action.end());
  }
  return file;
}

/// One for Raibo that holds the nominal pose, but for less than a degree.
inline Policy policy_of_others() {
  const Policy raibo = load_shipped_policy();
  PerceptronFile file = random_perceptron(
      "command scale 2 2 0.25, angular_velocity scale 0.25, gravity, joint_position, "
      "joint_velocity scale 0.05, last_action, phase period 0.8",
      6, HistoryOrder::kNewestFirst, Activation::kElu, {128, 64, 19}, {512, 256, 128});
  file.spec = raibo.spec();
  file.spec.action_scale_rad.fill(0.01);
  file.spec.action_clip = 1.0;
  return make_policy(file);
}

}  // namespace sandrunner
