// SPDX-License-Identifier: BSD-3-Clause
#include "policy/network_parameters.h"

#include <fmt/format.h>

#include "rt/base/errors.h"

namespace sandrunner {

std::array<int, 4> actor_sizes(const ActorInputs& sees) {
  std::array<int, 4> sizes = kActorSizes;
  sizes[0] = kCommandSize + (sees.encoding ? kHiddenSize : 0) +
             (sees.estimate ? kEstimateSize : 0) + (sees.proprioception ? kEncoderInputSize : 0) +
             (sees.terrain ? kTerrainSize : 0);
  return sizes;
}

std::vector<NamedTensor> tensors_of(NetworkParameters& parameters) {
  std::vector<NamedTensor> tensors = {
      {"observation.mean", {kObservationSize}, &parameters.observation_mean},
      {"observation.variance", {kObservationSize}, &parameters.observation_variance}};
  const auto add_layers = [&](const std::string& prefix, const auto& sizes, auto& layers) {
    for (std::size_t k = 0; k < layers.size(); ++k) {
      add_layer(fmt::format("{}.{}", prefix, k), sizes[k], sizes[k + 1], layers[k], tensors);
    }
  };
  switch (parameters.wiring.encoder) {
    case EncoderKind::kLstm: {
      constexpr std::size_t kGateRows = 4 * kHiddenSize;
      tensors.insert(
          tensors.end(),
          {{"encoder.weight_ih", {kGateRows, kEncoderInputSize}, &parameters.encoder_weight_ih},
           {"encoder.weight_hh", {kGateRows, kHiddenSize}, &parameters.encoder_weight_hh},
           {"encoder.bias_ih", {kGateRows}, &parameters.encoder_bias_ih},
           {"encoder.bias_hh", {kGateRows}, &parameters.encoder_bias_hh}});
      break;
    }
    case EncoderKind::kTcn: {
      parameters.encoder.resize(kTcnDilations.size() + 1);
      int inputs = kEncoderInputSize;
      for (std::size_t k = 0; k < kTcnDilations.size(); ++k) {
        add_layer(fmt::format("encoder.{}", k), kTcnTaps * inputs, kTcnChannels,
                  parameters.encoder[k], tensors);
        inputs = kTcnChannels;
      }
      add_layer(fmt::format("encoder.{}", kTcnDilations.size()), inputs, kHiddenSize,
                parameters.encoder.back(), tensors);
      break;
    }
    case EncoderKind::kInsight:
      parameters.encoder.resize(2);
      add_layers("encoder", std::array{kInsightSize, kInsightHidden, kHiddenSize},
                 parameters.encoder);
      break;
  }
  add_layers("estimator", kEstimatorSizes, parameters.estimator);
  add_layers("actor", actor_sizes(parameters.wiring.actor_sees), parameters.actor);
  return tensors;
}

void require_runnable(const NetworkParameters& parameters) {
  if (parameters.wiring.sees_insight()) {
    throw InputError(
        fmt::format("network: found networks that see what no sensor measures ({}), expected none",
                    wiring_text(parameters.wiring)));
  }
  NetworkParameters copy = parameters;
  for (const NamedTensor& tensor : tensors_of(copy)) {
    if (tensor.values->size() != tensor.size()) {
      throw InputError(fmt::format("network: tensor '{}' has {} values, expected {}", tensor.name,
                                   tensor.values->size(), tensor.size()));
    }
  }
}

}  // namespace sandrunner
