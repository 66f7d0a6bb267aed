// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/learner/lstm.h"

#include <utility>

namespace sandrunner::learner {
template <typename Scalar>
Lstm<Scalar>::Lstm(const ParameterLayout& layout, int steps, int envs,
                   const Kernels<Scalar>& kernels)
    : kernels_(&kernels),
      hidden_(layout.hidden()),
      parameters_(layout.encoder()),
      steps_(steps),
      envs_(envs),
      stacked_(Matrix<Scalar>::Zero(inputs_ + 1 + hidden_, steps * envs)),
      gates_(4 * hidden_, steps * envs),
      cell_(hidden_, (steps + 1) * envs),
      tanh_cell_(hidden_, steps * envs),
      output_(hidden_, steps * envs),
      cell_gradient_(hidden_, envs),
      recurrent_gradient_(hidden_, envs) {
  stacked_.row(inputs_).setOnes();
}

template <typename Scalar>
void Lstm<Scalar>::forward(const std::vector<LayerWeights<Scalar>>& weights,
                           const ConstMatrixRef<Scalar>& memory, const std::uint8_t* reset,
                           std::ptrdiff_t reset_stride) {
  cell_.leftCols(envs_) = memory.bottomRows(hidden_);
  for (int t = 0; t < steps_; ++t) {
    const int first = t * envs_;
    auto h_before = stacked_.block(inputs_ + 1, first, hidden_, envs_);
    if (t == 0) {
      h_before = memory.topRows(hidden_);
    } else {
      h_before = output_.middleCols(first - envs_, envs_);
    }
    // Assigned, not multiplied by a mask: a reset also clears a state that is not finite.
    for (int env = 0; env < envs_; ++env) {
      if (reset[t * reset_stride + env] == 0) continue;
      h_before.col(env).setZero();
      cell_.col(first + env).setZero();
    }
    kernels_->multiply({.samples = envs_,
                        .a = rows_of(std::as_const(stacked_).middleCols(first, envs_)),
                        .b = weights.front().forward,
                        .c = rows_of(gates_.middleCols(first, envs_))});
    kernels_->lstm_forward(envs_, hidden_, gates_.col(first).data(), cell_.col(first).data(),
                           cell_.col(first + envs_).data(), tanh_cell_.col(first).data(),
                           output_.col(first).data());
  }
}

template <typename Scalar>
void Lstm<Scalar>::backward(const std::vector<LayerWeights<Scalar>>& weights,
                            Matrix<Scalar>& output_gradient, const std::uint8_t* reset,
                            std::ptrdiff_t reset_stride, Scalar* gradient) {
  cell_gradient_.setZero();
  for (int t = steps_ - 1; t >= 0; --t) {
    const int first = t * envs_;
    kernels_->lstm_backward(envs_, hidden_, gates_.col(first).data(), cell_.col(first).data(),
                            tanh_cell_.col(first).data(), output_gradient.col(first).data(),
                            cell_gradient_.data());
    if (t == 0) break;
    // Through the recurrence into h of the step before, except where a reset cut it.
    kernels_->multiply({.samples = envs_,
                        .a = rows_of(std::as_const(gates_).middleCols(first, envs_)),
                        .b = weights.front().backward,
                        .c = rows_of(recurrent_gradient_)});
    for (int env = 0; env < envs_; ++env) {
      if (reset[t * reset_stride + env] != 0) {
        cell_gradient_.col(env).setZero();
      } else {
        output_gradient.col(first - envs_ + env) += recurrent_gradient_.col(env);
      }
    }
  }
  const int inputs = inputs_ + 1 + hidden_;
  kernels_->add_gradient({.samples = steps_ * envs_,
                          .rows = 4 * hidden_,
                          .columns = inputs,
                          .a = rows_of(std::as_const(gates_)),
                          .b = rows_of(std::as_const(stacked_)),
                          .c = {gradient + parameters_, inputs}});
}

template class Lstm<float>;
template class Lstm<double>;

}  // namespace sandrunner::learner
