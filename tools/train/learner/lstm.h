// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "tools/train/learner/matrix.h"
#include "tools/train/learner/weights.h"

namespace sandrunner::learner {

/// One LSTM layer over a window of steps, for a block of environments (columns), with everything
/// kept that back-propagation through the whole window needs. Owns working memory, no weights.
///
/// Weights W: [W_ih | bias | W_hh], (4 hidden) x (inputs + 1 + hidden), row-major, gate order i, f,
/// g, o: a step is one matrix product with [x; 1; h]. Instantiated for float (training) and double
/// (tests).
template <typename Scalar>
class Lstm {
 public:
  Lstm(int inputs, int hidden, int steps, int envs, const Kernels<Scalar>& kernels);

  /// Input of step t, inputs x envs: to be filled before `forward`.
  auto input(int t) { return stacked_.block(0, t * envs_, inputs_, envs_); }

  /// Runs all steps. h0, c0: state before the first step, hidden x envs. reset + t * reset_stride:
  /// for each environment, whether its state is cleared before step t.
  void forward(const LayerWeights<Scalar>& weights, const ConstMatrixRef<Scalar>& h0,
               const ConstMatrixRef<Scalar>& c0, const std::uint8_t* reset,
               std::ptrdiff_t reset_stride);

  /// Outputs h of all steps: hidden x (steps * envs), column t * envs + env.
  const Matrix<Scalar>& output() const { return output_; }
  /// Cell state after the last step, hidden x envs.
  auto last_cell() const { return cell_.rightCols(envs_); }

  /// After `forward`: adds dL/dW to `weight_gradient`, given dL/dh of the outputs (as `output`),
  /// which it uses as working memory. Nothing flows back into h0, c0. Destroys what `forward` kept.
  void backward(const LayerWeights<Scalar>& weights, Matrix<Scalar>& output_gradient,
                const std::uint8_t* reset, std::ptrdiff_t reset_stride, Scalar* weight_gradient);

 private:
  const Kernels<Scalar>* kernels_;
  int inputs_;
  int hidden_;
  int steps_;
  int envs_;
  Matrix<Scalar> stacked_;    // [x; 1; h before the step]
  Matrix<Scalar> gates_;      // activated i, f, g, o; in backward the gradient before activation
  Matrix<Scalar> cell_;       // c before each step, and after the last
  Matrix<Scalar> tanh_cell_;  // tanh of c after each step
  Matrix<Scalar> output_;
  Matrix<Scalar> cell_gradient_;       // hidden x envs
  Matrix<Scalar> recurrent_gradient_;  // hidden x envs
};

}  // namespace sandrunner::learner
