// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/learner/mlp.h"

#include "tools/train/learner/activations.h"

namespace sandrunner::learner {
namespace {

template <typename Scalar>
void add_bias(int n, const Scalar* __restrict bias, Scalar* __restrict y) {
  for (int k = 0; k < n; ++k) y[k] += bias[k];
}

template <typename Scalar>
void add_bias_and_activate(int n, const Scalar* __restrict bias, Scalar* __restrict y) {
  for (int k = 0; k < n; ++k) {
    const Scalar x = y[k] + bias[k];
    y[k] = x > 0 ? x : kLeakySlope<Scalar> * x;
  }
}

/// The sign of the activated output is the sign of the input.
template <typename Scalar>
void activate_backward(int n, const Scalar* __restrict activated, Scalar* __restrict gradient) {
  for (int k = 0; k < n; ++k) {
    gradient[k] = activated[k] > 0 ? gradient[k] : kLeakySlope<Scalar> * gradient[k];
  }
}

}  // namespace

template <typename Scalar>
Mlp<Scalar>::Mlp(const std::vector<LayerView>& layers, int max_columns) : layers_(layers) {
  for (const LayerView& layer : layers_) {
    activations_.emplace_back(layer.outputs, max_columns);
    gradients_.emplace_back(layer.outputs, max_columns);
  }
}

template <typename Scalar>
void Mlp<Scalar>::forward(const Scalar* parameters, const ConstMatrixRef<Scalar>& x) {
  const Eigen::Index n = x.cols();
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    const LayerView& layer = layers_[i];
    const ConstWeight<Scalar> w(parameters + layer.weight, layer.outputs, layer.inputs);
    auto y = activations_[i].leftCols(n);
    if (i == 0) {
      y.noalias() = w * x;
    } else {
      y.noalias() = w * activations_[i - 1].leftCols(n);
    }
    const bool last = i + 1 == layers_.size();
    const Scalar* bias = parameters + layer.bias;
    for (Eigen::Index column = 0; column < n; ++column) {
      if (last) {
        add_bias(layer.outputs, bias, y.col(column).data());
      } else {
        add_bias_and_activate(layer.outputs, bias, y.col(column).data());
      }
    }
  }
}

template <typename Scalar>
void Mlp<Scalar>::backward(const Scalar* parameters, const ConstMatrixRef<Scalar>& x,
                           Scalar* gradient) {
  const Eigen::Index n = x.cols();
  for (std::size_t i = layers_.size(); i-- > 0;) {
    const LayerView& layer = layers_[i];
    const auto dy = gradients_[i].leftCols(n);
    Scalar* bias_gradient = gradient + layer.bias;
    for (Eigen::Index column = 0; column < n; ++column) {
      add_bias(layer.outputs, dy.col(column).data(), bias_gradient);
    }
    Weight<Scalar> dw(gradient + layer.weight, layer.outputs, layer.inputs);
    if (i == 0) {
      dw.noalias() += dy * x.transpose();
      break;
    }
    const auto below = activations_[i - 1].leftCols(n);
    dw.noalias() += dy * below.transpose();
    const ConstWeight<Scalar> w(parameters + layer.weight, layer.outputs, layer.inputs);
    auto dx = gradients_[i - 1].leftCols(n);
    dx.noalias() = w.transpose() * dy;
    for (Eigen::Index column = 0; column < n; ++column) {
      activate_backward(layer.inputs, below.col(column).data(), dx.col(column).data());
    }
  }
}

template <typename Scalar>
void Mlp<Scalar>::add_input_gradient(const Scalar* parameters, int first,
                                     MatrixRef<Scalar> dx) const {
  const LayerView& layer = layers_.front();
  const ConstWeight<Scalar> w(parameters + layer.weight, layer.outputs, layer.inputs);
  dx.noalias() +=
      w.middleCols(first, dx.rows()).transpose() * gradients_.front().leftCols(dx.cols());
}

template class Mlp<float>;
template class Mlp<double>;

}  // namespace sandrunner::learner
