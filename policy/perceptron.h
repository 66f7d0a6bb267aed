// SPDX-License-Identifier: BSD-3-Clause
// Networks that others trained: multilayer perceptrons of a described observation.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "policy/named_tensors.h"
#include "policy/network.h"

namespace sandrunner {

/// Between the layers; the last one is linear.
enum class Activation {
  kElu,        ///< x above 0, exp(x) - 1 else
  kRelu,       ///< x above 0, 0 else
  kLeakyRelu,  ///< x above 0, 0.01 x else
  kTanh,
};
Activation parse_activation(const std::string& where, const std::string& text);
std::string activation_text(Activation activation);

/// A perceptron as a file holds it.
struct PerceptronParameters {
  static constexpr int kMostHidden = 4, kWidest = 512;
  /// Of the estimator's output, the first are a velocity; the others, divided by their Euclidean
  /// norm, a latent (HIMLoco, "him_estimator.py").
  static constexpr int kVelocitySize = 3;

  int policy_hz = 50;  ///< divides kPolicyHz
  ObservationLayout observation;
  Activation activation = Activation::kElu;
  JointArray<int> joint_of{};   ///< the robot's joint of each of the network's
  std::vector<int> estimator;   ///< widths of its layers, the last of its output; empty: none
  std::vector<int> actor;       ///< widths of its hidden layers
  double velocity_scale = 1.0;  ///< the estimator's velocity is this times that in m/s
  std::vector<DenseParameters> estimator_layers, actor_layers;

  /// Inputs of the actor: all that it sees, or, with an estimator, the newest observation and the
  /// estimator's output.
  int actor_inputs() const;
};

/// Names, shapes and places of the tensors; sizes the layers. Throws InputError for widths beyond
/// the limits, with `where` in front.
std::vector<NamedTensor> tensors_of(const std::string& where, PerceptronParameters& parameters);

/// A perceptron that runs. Same bits from every compiler, as `Network`. Copies share the weights.
class Perceptron {
 public:
  /// `nominal_rad`: the robot's, which the observation is relative to; `action_clip` as PolicySpec.
  Perceptron(const PerceptronParameters& parameters, const JointArray<double>& nominal_rad,
             double action_clip);

  /// One step at kPolicyHz, which counts at the network's own rate; between those, the answer
  /// stays. The action is in the robot's order; the estimate is NaN but for the velocity of an
  /// estimator. Real-time safe.
  void step(const std::array<float, kObservationSize>& observation, NetworkState& state,
            NetworkOutput& output) const noexcept;

  /// The network alone: `input` as arranged, the action in its own order; the velocity is NaN
  /// without an estimator. Real-time safe.
  void answer(const float* input, JointArray<float>& action,
              std::array<float, 3>& velocity_mps) const noexcept;

  void touch_weights() const noexcept;
  std::size_t weight_bytes() const noexcept;

 private:
  struct Packed;
  std::shared_ptr<const Packed> packed_;
};

}  // namespace sandrunner
