// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/learner/lstm.h"

#include "tools/train/learner/activations.h"

namespace sandrunner::learner {
namespace {

/// Gates before activation (i, f, g, o, each n long) and c -> activated gates, c', tanh(c'), h'.
template <typename Scalar>
void activate(int n, Scalar* __restrict gates, const Scalar* __restrict cell,
              Scalar* __restrict next_cell, Scalar* __restrict tanh_cell,
              Scalar* __restrict output) {
  for (int k = 0; k < n; ++k) {
    const Scalar in = sigmoid(gates[k]);
    const Scalar forget = sigmoid(gates[n + k]);
    const Scalar candidate = tanh_activation(gates[2 * n + k]);
    const Scalar out = sigmoid(gates[3 * n + k]);
    const Scalar c = forget * cell[k] + in * candidate;
    const Scalar tanh_c = tanh_activation(c);
    gates[k] = in;
    gates[n + k] = forget;
    gates[2 * n + k] = candidate;
    gates[3 * n + k] = out;
    next_cell[k] = c;
    tanh_cell[k] = tanh_c;
    output[k] = out * tanh_c;
  }
}

/// Activated gates -> gradient before activation; dc: gradient of c' on entry, of c on return.
template <typename Scalar>
void activate_backward(int n, Scalar* __restrict gates, const Scalar* __restrict cell,
                       const Scalar* __restrict tanh_cell, const Scalar* __restrict dh,
                       Scalar* __restrict dc) {
  constexpr Scalar kOne = 1;
  for (int k = 0; k < n; ++k) {
    const Scalar in = gates[k];
    const Scalar forget = gates[n + k];
    const Scalar candidate = gates[2 * n + k];
    const Scalar out = gates[3 * n + k];
    const Scalar tanh_c = tanh_cell[k];
    const Scalar d = dc[k] + dh[k] * out * (kOne - tanh_c * tanh_c);
    gates[k] = d * candidate * in * (kOne - in);
    gates[n + k] = d * cell[k] * forget * (kOne - forget);
    gates[2 * n + k] = d * in * (kOne - candidate * candidate);
    gates[3 * n + k] = dh[k] * tanh_c * out * (kOne - out);
    dc[k] = d * forget;
  }
}

}  // namespace

template <typename Scalar>
Lstm<Scalar>::Lstm(int inputs, int hidden, int steps, int envs)
    : inputs_(inputs),
      hidden_(hidden),
      steps_(steps),
      envs_(envs),
      stacked_(Matrix<Scalar>::Zero(inputs + 1 + hidden, steps * envs)),
      gates_(4 * hidden, steps * envs),
      cell_(hidden, (steps + 1) * envs),
      tanh_cell_(hidden, steps * envs),
      output_(hidden, steps * envs),
      cell_gradient_(hidden, envs),
      recurrent_gradient_(hidden, envs) {
  stacked_.row(inputs).setOnes();
}

template <typename Scalar>
void Lstm<Scalar>::forward(const Scalar* weight, const ConstMatrixRef<Scalar>& h0,
                           const ConstMatrixRef<Scalar>& c0, const std::uint8_t* reset,
                           std::ptrdiff_t reset_stride) {
  const ConstWeight<Scalar> w(weight, 4 * hidden_, inputs_ + 1 + hidden_);
  cell_.leftCols(envs_) = c0;
  for (int t = 0; t < steps_; ++t) {
    const int first = t * envs_;
    auto h_before = stacked_.block(inputs_ + 1, first, hidden_, envs_);
    if (t == 0) {
      h_before = h0;
    } else {
      h_before = output_.middleCols(first - envs_, envs_);
    }
    // Assigned, not multiplied by a mask: a reset also clears a state that is not finite.
    for (int env = 0; env < envs_; ++env) {
      if (reset[t * reset_stride + env] == 0) continue;
      h_before.col(env).setZero();
      cell_.col(first + env).setZero();
    }
    gates_.middleCols(first, envs_).noalias() = w * stacked_.middleCols(first, envs_);
    for (int column = first; column < first + envs_; ++column) {
      activate(hidden_, gates_.col(column).data(), cell_.col(column).data(),
               cell_.col(column + envs_).data(), tanh_cell_.col(column).data(),
               output_.col(column).data());
    }
  }
}

template <typename Scalar>
void Lstm<Scalar>::backward(const Scalar* weight, Matrix<Scalar>& output_gradient,
                            const std::uint8_t* reset, std::ptrdiff_t reset_stride,
                            Scalar* weight_gradient) {
  const ConstWeight<Scalar> w(weight, 4 * hidden_, inputs_ + 1 + hidden_);
  cell_gradient_.setZero();
  for (int t = steps_ - 1; t >= 0; --t) {
    const int first = t * envs_;
    for (int env = 0; env < envs_; ++env) {
      const int column = first + env;
      activate_backward(hidden_, gates_.col(column).data(), cell_.col(column).data(),
                        tanh_cell_.col(column).data(), output_gradient.col(column).data(),
                        cell_gradient_.col(env).data());
    }
    if (t == 0) break;
    // Through the recurrence into h of the step before, except where a reset cut it.
    recurrent_gradient_.noalias() =
        w.rightCols(hidden_).transpose() * gates_.middleCols(first, envs_);
    for (int env = 0; env < envs_; ++env) {
      if (reset[t * reset_stride + env] != 0) {
        cell_gradient_.col(env).setZero();
      } else {
        output_gradient.col(first - envs_ + env) += recurrent_gradient_.col(env);
      }
    }
  }
  Weight<Scalar> dw(weight_gradient, 4 * hidden_, inputs_ + 1 + hidden_);
  dw.noalias() += gates_ * stacked_.transpose();
}

template class Lstm<float>;
template class Lstm<double>;

}  // namespace sandrunner::learner
