// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "tools/train/learner/matrix.h"
#include "tools/train/learner/weights.h"

namespace sandrunner::learner {

/// Multi-layer perceptron, leaky ReLU on the hidden layers, linear output, one sample a column.
/// Owns working memory for up to `max_columns` samples, no weights. Instantiated for float
/// (training) and double (tests).
template <typename Scalar>
class Mlp {
 public:
  Mlp(const std::vector<LayerView>& layers, int max_columns, const Kernels<Scalar>& kernels);

  /// x: inputs x n.
  void forward(const std::vector<LayerWeights<Scalar>>& weights, const ConstMatrixRef<Scalar>& x);

  /// After `forward`: outputs x n.
  auto output(int n) const { return activations_.back().leftCols(n); }
  /// dL/d output: to be filled before `backward`.
  auto output_gradient(int n) { return gradients_.back().leftCols(n); }

  /// After `forward` with the same x: adds dL/d parameters to `gradient` (flat array).
  void backward(const std::vector<LayerWeights<Scalar>>& weights, const ConstMatrixRef<Scalar>& x,
                Scalar* gradient);

  /// After `backward`: adds dL/dx of the inputs for which the first layer is packed backwards.
  void add_input_gradient(const std::vector<LayerWeights<Scalar>>& weights,
                          MatrixRef<Scalar> dx) const;

 private:
  const Kernels<Scalar>* kernels_;
  std::vector<LayerView> layers_;
  std::vector<Matrix<Scalar>> activations_;  // output of each layer, after its activation
  std::vector<Matrix<Scalar>> gradients_;    // dL/d (output of each layer before its activation)
};

}  // namespace sandrunner::learner
