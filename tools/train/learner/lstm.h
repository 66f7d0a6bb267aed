// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

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
  Lstm(const ParameterLayout& layout, int steps, int envs, const Kernels<Scalar>& kernels);

  /// What the environments observe in step t, 33 x envs: to be given before `forward`.
  void set_input(int t, const ConstMatrixRef<Scalar>& observation,
                 const ConstMatrixRef<Scalar>& /*insight*/) {
    stacked_.block(0, t * envs_, inputs_, envs_) = observation.bottomRows(inputs_);
  }

  /// Runs all steps. memory: [h; c] before the first step, 2 hidden x envs. reset + t *
  /// reset_stride: for each environment, whether its memory is cleared before step t.
  void forward(const std::vector<LayerWeights<Scalar>>& weights,
               const ConstMatrixRef<Scalar>& memory, const std::uint8_t* reset,
               std::ptrdiff_t reset_stride);

  /// Outputs h of all steps: hidden x (steps * envs), column t * envs + env.
  const Matrix<Scalar>& output() const { return output_; }
  /// Memory after the last step.
  void remember(MatrixRef<Scalar> memory) const {
    memory.topRows(hidden_) = output_.rightCols(envs_);
    memory.bottomRows(hidden_) = cell_.rightCols(envs_);
  }

  /// After `forward`: adds dL/dW to `gradient` (flat array), given dL/dh of the outputs (as
  /// `output`), which it uses as working memory. Nothing flows back into the memory. Destroys what
  /// `forward` kept.
  void backward(const std::vector<LayerWeights<Scalar>>& weights, Matrix<Scalar>& output_gradient,
                const std::uint8_t* reset, std::ptrdiff_t reset_stride, Scalar* gradient);

 private:
  const Kernels<Scalar>* kernels_;
  int inputs_ = kProprioceptionSize;
  int hidden_;
  std::ptrdiff_t parameters_;
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
