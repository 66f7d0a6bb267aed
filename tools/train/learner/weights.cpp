// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/learner/weights.h"

#include <algorithm>

namespace sandrunner::learner {
namespace {

/// input_gradients: inputs of the first layer whose gradient is asked for.
template <typename Scalar>
std::vector<LayerWeights<Scalar>> make_layers(const std::vector<LayerView>& views,
                                              int input_gradients) {
  std::vector<LayerWeights<Scalar>> layers;
  for (const LayerView& view : views) {
    layers.push_back(
        {Panels<Scalar>(view.inputs, view.outputs),
         Panels<Scalar>(view.outputs, layers.empty() ? input_gradients : view.inputs)});
  }
  return layers;
}

/// first_input: of those of the first layer whose gradient is asked for.
template <typename Scalar>
void pack_layers(const std::vector<LayerView>& views, const Scalar* parameters, int first_input,
                 std::vector<LayerWeights<Scalar>>& layers) {
  for (std::size_t i = 0; i < views.size(); ++i) {
    const LayerView& view = views[i];
    const Scalar* weight = parameters + view.weight;
    layers[i].forward.pack(weight, 1, view.inputs, parameters + view.bias);
    layers[i].backward.pack(weight + (i == 0 ? first_input : 0), view.inputs, 1);
  }
}

}  // namespace

template <typename Scalar>
Weights<Scalar>::Weights(const ParameterLayout& layout)
    : layout_(layout),
      encoder_(make_layers<Scalar>(layout.encoder_layers(), 0)),
      estimator_(make_layers<Scalar>(layout.estimator(), layout.hidden())),
      actor_(make_layers<Scalar>(layout.actor(),
                                 layout.sizes().wiring.actor_sees.encoding ? layout.hidden() : 0)),
      critic_(make_layers<Scalar>(layout.critic(), 0)),
      log_std_(kActionSize) {
  if (layout.encoder_layers().empty()) {
    encoder_.push_back(
        {Panels<Scalar>(kProprioceptionSize + 1 + layout.hidden(), 4 * layout.hidden()),
         Panels<Scalar>(4 * layout.hidden(), layout.hidden())});
  }
}

template <typename Scalar>
void Weights<Scalar>::set(const Scalar* parameters) {
  if (layout_.encoder_layers().empty()) {
    const Scalar* encoder = parameters + layout_.encoder();
    const int inputs = kProprioceptionSize + 1 + layout_.hidden();
    encoder_.front().forward.pack(encoder, 1, inputs);
    encoder_.front().backward.pack(encoder + kProprioceptionSize + 1, inputs, 1);
  }
  pack_layers(layout_.encoder_layers(), parameters, 0, encoder_);
  pack_layers(layout_.estimator(), parameters, 0, estimator_);
  pack_layers(layout_.actor(), parameters, kCommandSize, actor_);
  pack_layers(layout_.critic(), parameters, 0, critic_);
  std::copy_n(parameters + layout_.log_std(), kActionSize, log_std_.begin());
}

template class Weights<float>;
template class Weights<double>;

}  // namespace sandrunner::learner
