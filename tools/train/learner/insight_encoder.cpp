// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/learner/insight_encoder.h"

#include "tools/train/learner/tanh.h"

namespace sandrunner::learner {

template <typename Scalar>
InsightEncoder<Scalar>::InsightEncoder(const ParameterLayout& layout, int steps, int envs,
                                       const Kernels<Scalar>& kernels)
    : envs_(envs),
      mlp_(layout.encoder_layers(), steps * envs, kernels),
      input_(kInsightSize, steps * envs),
      output_(layout.hidden(), steps * envs) {}

template <typename Scalar>
void InsightEncoder<Scalar>::forward(const std::vector<LayerWeights<Scalar>>& weights,
                                     const ConstMatrixRef<Scalar>& /*memory*/,
                                     const std::uint8_t* /*reset*/,
                                     std::ptrdiff_t /*reset_stride*/) {
  const int n = static_cast<int>(input_.cols());
  mlp_.forward(weights, input_);
  output_ = mlp_.output(n);
  apply_tanh(output_);
}

template <typename Scalar>
void InsightEncoder<Scalar>::backward(const std::vector<LayerWeights<Scalar>>& weights,
                                      Matrix<Scalar>& output_gradient,
                                      const std::uint8_t* /*reset*/,
                                      std::ptrdiff_t /*reset_stride*/, Scalar* gradient) {
  const int n = static_cast<int>(input_.cols());
  mlp_.output_gradient(n) = before_tanh(output_, output_gradient);
  mlp_.backward(weights, input_, gradient);
}

template class InsightEncoder<float>;
template class InsightEncoder<double>;

}  // namespace sandrunner::learner
