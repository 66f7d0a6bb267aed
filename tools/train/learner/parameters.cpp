// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/learner/parameters.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tools/train/learner/random.h"

namespace sandrunner::learner {
namespace {

constexpr double kActorOutputScale = 0.05;  // first actions: almost the nominal pose
constexpr double kCriticOutputScale = 0.3;
constexpr float kForgetBias = 1.0f;  // the memory starts out remembering

}  // namespace

ParameterLayout::ParameterLayout(const NetworkSizes& sizes, int privileged)
    : sizes_(sizes), privileged_(privileged) {
  add_encoder();
  estimator_ = add_mlp("estimator", sizes.hidden, sizes.estimator, kEstimateSize);
  actor_ = add_mlp("actor", actor_inputs(), sizes.actor, kActionSize);
  critic_ = add_mlp("critic", privileged, sizes.critic, 1);
  log_std_ = add("log_std", kActionSize, 1);
}

int ParameterLayout::actor_inputs() const {
  const ActorInputs& sees = sizes_.wiring.actor_sees;
  return kCommandSize + (sees.encoding ? sizes_.hidden : 0) + (sees.estimate ? kEstimateSize : 0) +
         (sees.proprioception ? kProprioceptionSize : 0) + (sees.terrain ? kTerrainSize : 0);
}

int ParameterLayout::memory() const {
  switch (sizes_.wiring.encoder) {
    case EncoderKind::kTcn:
      return kTcnPast * kProprioceptionSize + 1;
    case EncoderKind::kInsight:
      return 0;
    case EncoderKind::kLstm:
      break;
  }
  return 2 * sizes_.hidden;
}

void ParameterLayout::add_encoder() {
  const int hidden = sizes_.hidden;
  switch (sizes_.wiring.encoder) {
    case EncoderKind::kLstm:
      encoder_ = add("encoder", 4 * hidden, kProprioceptionSize + 1 + hidden);
      break;
    case EncoderKind::kTcn: {
      int inputs = kProprioceptionSize;
      for (std::size_t i = 0; i < kTcnDilations.size(); ++i) {
        add_layer("encoder", kTcnTaps * inputs, sizes_.channels, encoder_layers_);
        inputs = sizes_.channels;
      }
      add_layer("encoder", inputs, hidden, encoder_layers_);
      break;
    }
    case EncoderKind::kInsight:
      encoder_layers_ = add_mlp("encoder", kInsightSize, sizes_.insight, hidden);
      break;
  }
}

std::ptrdiff_t ParameterLayout::add(std::string name, int rows, int cols) {
  const std::ptrdiff_t offset = size_;
  tensors_.push_back({std::move(name), rows, cols, offset});
  size_ += static_cast<std::ptrdiff_t>(rows) * cols;
  return offset;
}

std::vector<LayerView> ParameterLayout::add_mlp(const std::string& name, int inputs,
                                                const std::vector<int>& hidden, int outputs) {
  std::vector<int> widths = hidden;
  widths.push_back(outputs);
  std::vector<LayerView> layers;
  for (const int width : widths) {
    add_layer(name, inputs, width, layers);
    inputs = width;
  }
  return layers;
}

void ParameterLayout::add_layer(const std::string& name, int inputs, int outputs,
                                std::vector<LayerView>& layers) {
  const std::string prefix = name + "." + std::to_string(layers.size());
  LayerView layer{inputs, outputs, 0, 0};
  layer.weight = add(prefix + ".weight", outputs, inputs);
  layer.bias = add(prefix + ".bias", outputs, 1);
  layers.push_back(layer);
}

std::vector<float> initial_parameters(const ParameterLayout& layout, std::uint64_t seed,
                                      double action_std) {
  std::vector<float> parameters(static_cast<std::size_t>(layout.size()), 0.0f);
  // Drawn by position in the array: one normal value a weight.
  const auto fill = [&](std::ptrdiff_t offset, std::ptrdiff_t count, double scale) {
    for (std::ptrdiff_t i = offset; i < offset + count; ++i) {
      const auto index = static_cast<std::uint64_t>(i);
      parameters[static_cast<std::size_t>(i)] =
          static_cast<float>(scale) *
          random_normal_pair(seed, Stream::kInitialization, index, 0).first;
    }
  };
  const auto fill_mlp = [&](const std::vector<LayerView>& layers, double output_scale) {
    for (const LayerView& layer : layers) {
      // He et al. 2015: a rectifier passes half of the variance; the last layer has none.
      const bool last = &layer == &layers.back();
      const double gain = last ? output_scale : std::sqrt(2.0);
      fill(layer.weight, static_cast<std::ptrdiff_t>(layer.inputs) * layer.outputs,
           gain / std::sqrt(static_cast<double>(layer.inputs)));
    }
  };

  const auto fill_lstm = [&] {
    const int hidden = layout.hidden();
    const int encoder_cols = kProprioceptionSize + 1 + hidden;
    fill(layout.encoder(), static_cast<std::ptrdiff_t>(4 * hidden) * encoder_cols,
         1.0 / std::sqrt(static_cast<double>(kProprioceptionSize + hidden)));
    for (int row = 0; row < 4 * hidden; ++row) {
      const bool forget_gate = row >= hidden && row < 2 * hidden;
      const std::ptrdiff_t bias =
          layout.encoder() + static_cast<std::ptrdiff_t>(row) * encoder_cols + kProprioceptionSize;
      parameters[static_cast<std::size_t>(bias)] = forget_gate ? kForgetBias : 0.0f;
    }
  };

  if (layout.encoder_layers().empty()) fill_lstm();
  fill_mlp(layout.encoder_layers(), 1.0);
  fill_mlp(layout.estimator(), 1.0);
  fill_mlp(layout.actor(), kActorOutputScale);
  fill_mlp(layout.critic(), kCriticOutputScale);
  std::fill_n(parameters.begin() + layout.log_std(), kActionSize,
              static_cast<float>(std::log(action_std)));
  return parameters;
}

void to_policy(const ParameterLayout& layout, const std::vector<float>& parameters,
               NetworkParameters& policy) {
  policy.wiring = layout.sizes().wiring;
  const auto layers = [&](const std::vector<LayerView>& from, auto& to) {
    for (std::size_t k = 0; k < from.size(); ++k) {
      const float* const weight = parameters.data() + from[k].weight;
      const float* const bias = parameters.data() + from[k].bias;
      to[k].weight.assign(weight, weight + std::ptrdiff_t{from[k].outputs} * from[k].inputs);
      to[k].bias.assign(bias, bias + from[k].outputs);
    }
  };
  layers(layout.estimator(), policy.estimator);
  layers(layout.actor(), policy.actor);
  policy.encoder.resize(layout.encoder_layers().size());
  layers(layout.encoder_layers(), policy.encoder);
  if (policy.wiring.encoder != EncoderKind::kLstm) return;
  const int hidden = layout.hidden();
  const int cols = kProprioceptionSize + 1 + hidden;
  const auto columns = [&](int first, int count) {
    std::vector<float> values;
    for (int row = 0; row < 4 * hidden; ++row) {
      const float* begin = parameters.data() + layout.encoder() + row * cols + first;
      values.insert(values.end(), begin, begin + count);
    }
    return values;
  };
  policy.encoder_weight_ih = columns(0, kProprioceptionSize);
  policy.encoder_weight_hh = columns(kProprioceptionSize + 1, hidden);
  policy.encoder_bias_ih = columns(kProprioceptionSize, 1);
  policy.encoder_bias_hh.assign(policy.encoder_bias_ih.size(), 0.0f);
}

void from_policy(const NetworkParameters& policy, const ParameterLayout& layout,
                 std::vector<float>& parameters) {
  const auto layers = [&](const auto& from, const std::vector<LayerView>& to) {
    for (std::size_t k = 0; k < to.size(); ++k) {
      std::ranges::copy(from[k].weight, parameters.begin() + to[k].weight);
      std::ranges::copy(from[k].bias, parameters.begin() + to[k].bias);
    }
  };
  layers(policy.estimator, layout.estimator());
  layers(policy.actor, layout.actor());
  layers(policy.encoder, layout.encoder_layers());
  if (policy.wiring.encoder != EncoderKind::kLstm) return;
  const int hidden = layout.hidden();
  const int cols = kProprioceptionSize + 1 + hidden;
  for (int row = 0; row < 4 * hidden; ++row) {
    float* const to = parameters.data() + layout.encoder() + row * cols;
    std::copy_n(&policy.encoder_weight_ih[row * kProprioceptionSize], kProprioceptionSize, to);
    to[kProprioceptionSize] = policy.encoder_bias_ih[row] + policy.encoder_bias_hh[row];
    std::copy_n(&policy.encoder_weight_hh[row * hidden], hidden, to + kProprioceptionSize + 1);
  }
}

}  // namespace sandrunner::learner
