// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/learner/mlp.h"

#include <utility>

namespace sandrunner::learner {

template <typename Scalar>
Mlp<Scalar>::Mlp(const std::vector<LayerView>& layers, int max_columns,
                 const Kernels<Scalar>& kernels)
    : kernels_(&kernels), layers_(layers) {
  for (const LayerView& layer : layers_) {
    activations_.emplace_back(layer.outputs, max_columns);
    gradients_.emplace_back(layer.outputs, max_columns);
  }
}

template <typename Scalar>
void Mlp<Scalar>::forward(const std::vector<LayerWeights<Scalar>>& weights,
                          const ConstMatrixRef<Scalar>& x) {
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    Product<Scalar> product{.samples = static_cast<int>(x.cols()),
                            .a = i == 0 ? rows_of(x) : rows_of(std::as_const(activations_[i - 1])),
                            .b = weights[i].forward,
                            .c = rows_of(activations_[i])};
    if (i + 1 < layers_.size()) product.finish = Finish::kLeakyRelu;
    kernels_->multiply(product);
  }
}

template <typename Scalar>
void Mlp<Scalar>::backward(const std::vector<LayerWeights<Scalar>>& weights,
                           const ConstMatrixRef<Scalar>& x, Scalar* gradient) {
  const auto samples = static_cast<int>(x.cols());
  for (std::size_t i = layers_.size(); i-- > 0;) {
    const LayerView& layer = layers_[i];
    const auto dy = rows_of(std::as_const(gradients_[i]));
    const auto below = i == 0 ? rows_of(x) : rows_of(std::as_const(activations_[i - 1]));
    kernels_->add_samples(samples, layer.outputs, dy, gradient + layer.bias);
    kernels_->add_gradient({.samples = samples,
                            .rows = layer.outputs,
                            .columns = layer.inputs,
                            .a = dy,
                            .b = below,
                            .c = {gradient + layer.weight, layer.inputs}});
    if (i == 0) break;
    // The sign of the activated output is the sign of the input.
    kernels_->multiply({.samples = samples,
                        .a = dy,
                        .b = weights[i].backward,
                        .c = rows_of(gradients_[i - 1]),
                        .finish = Finish::kLeakyReluBackward,
                        .activated = below});
  }
}

template <typename Scalar>
void Mlp<Scalar>::add_input_gradient(const std::vector<LayerWeights<Scalar>>& weights,
                                     MatrixRef<Scalar> dx) const {
  kernels_->multiply({.samples = static_cast<int>(dx.cols()),
                      .a = rows_of(gradients_.front()),
                      .b = weights.front().backward,
                      .c = rows_of(dx),
                      .add = true});
}

template class Mlp<float>;
template class Mlp<double>;

}  // namespace sandrunner::learner
