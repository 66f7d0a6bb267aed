// SPDX-License-Identifier: BSD-3-Clause
#include "policy/network_parameters.h"

#include <fmt/format.h>

#include <functional>
#include <numeric>

namespace sandrunner {

std::size_t NamedTensor::size() const {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

std::vector<NamedTensor> tensors_of(NetworkParameters& parameters) {
  constexpr std::size_t kGateRows = 4 * kHiddenSize;
  std::vector<NamedTensor> tensors = {
      {"observation.mean", {kObservationSize}, &parameters.observation_mean},
      {"observation.variance", {kObservationSize}, &parameters.observation_variance},
      {"encoder.weight_ih", {kGateRows, kEncoderInputSize}, &parameters.encoder_weight_ih},
      {"encoder.weight_hh", {kGateRows, kHiddenSize}, &parameters.encoder_weight_hh},
      {"encoder.bias_ih", {kGateRows}, &parameters.encoder_bias_ih},
      {"encoder.bias_hh", {kGateRows}, &parameters.encoder_bias_hh}};
  const auto add_layers = [&tensors](const std::string& prefix, const std::array<int, 4>& sizes,
                                     std::array<DenseParameters, 3>& layers) {
    for (std::size_t k = 0; k < layers.size(); ++k) {
      const auto inputs = static_cast<std::size_t>(sizes[k]);
      const auto outputs = static_cast<std::size_t>(sizes[k + 1]);
      const std::string layer = fmt::format("{}.{}", prefix, k);
      tensors.push_back({layer + ".weight", {outputs, inputs}, &layers[k].weight});
      tensors.push_back({layer + ".bias", {outputs}, &layers[k].bias});
    }
  };
  add_layers("estimator", kEstimatorSizes, parameters.estimator);
  add_layers("actor", kActorSizes, parameters.actor);
  return tensors;
}

}  // namespace sandrunner
