// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tools/train/learner/matrix.h"
#include "tools/train/learner/weights.h"

namespace sandrunner::learner {

/// An encoder without recurrence: three causal convolutions over time (kTcnTaps taps at
/// kTcnDilations, leaky ReLU) and a dense layer with tanh, which see the last 53 observations. For
/// a block of environments over a window of steps, with the functions of Lstm.
///
/// Its memory is the last 52 observations, oldest first, and how many of them are younger than the
/// last reset. Nothing else is carried on: gradients are exact, and a window gives the same bits as
/// its steps one by one. A tap behind a reset reads zero in every layer. A layer is computed only
/// at the times from which the layer above reads: 17, 5 and 1 of them for one step, 80, 68 and 32
/// for a window of 32.
template <typename Scalar>
class Tcn {
 public:
  Tcn(const ParameterLayout& layout, int steps, int envs, const Kernels<Scalar>& kernels);

  void set_input(int t, const ConstMatrixRef<Scalar>& observation,
                 const ConstMatrixRef<Scalar>& /*insight*/) {
    history_.middleCols((kTcnPast + t) * envs_, envs_) =
        observation.bottomRows(kProprioceptionSize);
  }
  void forward(const std::vector<LayerWeights<Scalar>>& weights,
               const ConstMatrixRef<Scalar>& memory, const std::uint8_t* reset,
               std::ptrdiff_t reset_stride);
  const Matrix<Scalar>& output() const { return output_; }
  void remember(MatrixRef<Scalar> memory) const;
  void backward(const std::vector<LayerWeights<Scalar>>& weights, Matrix<Scalar>& output_gradient,
                const std::uint8_t* reset, std::ptrdiff_t reset_stride, Scalar* gradient);

 private:
  /// A convolution with what `backward` needs of it. Columns: (index into `times`) * envs + env.
  struct Convolution {
    int dilation = 1;
    std::vector<int> times;    // steps at which it is computed; 0: the first of the window
    std::vector<int> sources;  // for each of them and each tap: index into the times below
    Matrix<Scalar> taps;       // kTcnTaps inputs on top of each other
    Matrix<Scalar> output;
    Matrix<Scalar> gradient;  // of the output before activation
  };

  void find_starts(const ConstMatrixRef<Scalar>& memory, const std::uint8_t* reset,
                   std::ptrdiff_t reset_stride);
  /// Whether a tap of an environment at `time` reads what lies behind a reset.
  bool is_cut(int time, int dilation, int tap, int env) const {
    return time - dilation * tap <
           starts_[static_cast<std::size_t>((time < 0 ? 0 : time + 1) * envs_ + env)];
  }
  void gather(const Matrix<Scalar>& below, Convolution& layer) const;
  void scatter(const Convolution& layer, Convolution& below) const;

  const Kernels<Scalar>* kernels_;
  std::vector<LayerView> layers_;  // convolutions, dense layer
  int steps_;
  int envs_;
  Matrix<Scalar> history_;  // observations from 52 steps before the window on
  // For each environment, the first step that counts: of all before the window, then of each step.
  std::vector<int> starts_;
  std::array<Convolution, kTcnDilations.size()> convolutions_;
  Matrix<Scalar> output_;
  Matrix<Scalar> dense_gradient_;
  Matrix<Scalar> taps_gradient_;
};

}  // namespace sandrunner::learner
