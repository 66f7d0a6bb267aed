// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tools/train/learner/matrix.h"
#include "tools/train/learner/mlp.h"
#include "tools/train/learner/weights.h"

namespace sandrunner::learner {

/// The encoder of a teacher: h = tanh(MLP(insight)), for a block of environments over a window of
/// steps. It remembers nothing. The functions are those of Lstm.
template <typename Scalar>
class InsightEncoder {
 public:
  InsightEncoder(const ParameterLayout& layout, int steps, int envs,
                 const Kernels<Scalar>& kernels);

  void set_input(int t, const ConstMatrixRef<Scalar>& /*observation*/,
                 const ConstMatrixRef<Scalar>& insight) {
    input_.middleCols(t * envs_, envs_) = insight;
  }
  void forward(const std::vector<LayerWeights<Scalar>>& weights,
               const ConstMatrixRef<Scalar>& memory, const std::uint8_t* reset,
               std::ptrdiff_t reset_stride);
  const Matrix<Scalar>& output() const { return output_; }
  void remember(MatrixRef<Scalar> /*memory*/) const {}
  void backward(const std::vector<LayerWeights<Scalar>>& weights, Matrix<Scalar>& output_gradient,
                const std::uint8_t* reset, std::ptrdiff_t reset_stride, Scalar* gradient);

 private:
  int envs_;
  Mlp<Scalar> mlp_;
  Matrix<Scalar> input_;
  Matrix<Scalar> output_;
};

}  // namespace sandrunner::learner
