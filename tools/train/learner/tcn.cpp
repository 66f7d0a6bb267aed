// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/learner/tcn.h"

#include <algorithm>
#include <set>
#include <utility>

#include "tools/train/learner/tanh.h"

namespace sandrunner::learner {
namespace {

/// The times from which a layer reads that is computed at `times`.
std::vector<int> times_below(const std::vector<int>& times, int dilation) {
  std::set<int> below;
  for (const int time : times) {
    for (int tap = 0; tap < kTcnTaps; ++tap) below.insert(time - dilation * tap);
  }
  return {below.begin(), below.end()};
}

}  // namespace

template <typename Scalar>
Tcn<Scalar>::Tcn(const ParameterLayout& layout, int steps, int envs, const Kernels<Scalar>& kernels)
    : kernels_(&kernels),
      layers_(layout.encoder_layers()),
      steps_(steps),
      envs_(envs),
      history_(kProprioceptionSize, (kTcnPast + steps) * envs),
      starts_(static_cast<std::size_t>((steps + 1) * envs)),
      output_(layout.hidden(), steps * envs),
      dense_gradient_(layout.hidden(), steps * envs) {
  std::vector<int> times;
  for (int t = 0; t < steps; ++t) times.push_back(t);
  for (std::size_t i = convolutions_.size(); i-- > 0;) {
    Convolution& layer = convolutions_[i];
    layer.dilation = kTcnDilations[i];
    layer.times = times;
    times = times_below(layer.times, layer.dilation);
    // The history begins 52 steps before the window, whatever the lowest layer reads.
    const std::vector<int>& below = times;
    for (const int time : layer.times) {
      for (int tap = 0; tap < kTcnTaps; ++tap) {
        const int source = time - layer.dilation * tap;
        const auto found = std::ranges::lower_bound(below, source);
        layer.sources.push_back(i == 0 ? source + kTcnPast
                                       : static_cast<int>(found - below.begin()));
      }
    }
    const auto columns = static_cast<int>(layer.times.size()) * envs;
    layer.taps.resize(layers_[i].inputs, columns);
    layer.output.resize(layers_[i].outputs, columns);
    layer.gradient.resize(layers_[i].outputs, columns);
  }
}

template <typename Scalar>
void Tcn<Scalar>::find_starts(const ConstMatrixRef<Scalar>& memory, const std::uint8_t* reset,
                              std::ptrdiff_t reset_stride) {
  for (int env = 0; env < envs_; ++env) {
    int start = -static_cast<int>(memory(kTcnPast * kProprioceptionSize, env));
    starts_[static_cast<std::size_t>(env)] = start;
    for (int t = 0; t < steps_; ++t) {
      if (reset[t * reset_stride + env] != 0) start = t;
      starts_[static_cast<std::size_t>((t + 1) * envs_ + env)] = start;
    }
  }
}

// Assigned, not multiplied by a mask: what lies behind a reset need not be finite.
template <typename Scalar>
void Tcn<Scalar>::gather(const Matrix<Scalar>& below, Convolution& layer) const {
  const Eigen::Index rows = below.rows();
  for (std::size_t i = 0; i < layer.times.size(); ++i) {
    for (int tap = 0; tap < kTcnTaps; ++tap) {
      const int source = layer.sources[i * kTcnTaps + static_cast<std::size_t>(tap)];
      for (int env = 0; env < envs_; ++env) {
        auto to =
            layer.taps.col(static_cast<Eigen::Index>(i) * envs_ + env).segment(tap * rows, rows);
        if (is_cut(layer.times[i], layer.dilation, tap, env)) {
          to.setZero();
        } else {
          to = below.col(source * envs_ + env);
        }
      }
    }
  }
}

// dL/d taps -> dL/d (output of the layer below before its activation).
template <typename Scalar>
void Tcn<Scalar>::scatter(const Convolution& layer, Convolution& below) const {
  const Eigen::Index rows = below.output.rows();
  below.gradient.setZero();
  for (std::size_t i = 0; i < layer.times.size(); ++i) {
    for (int tap = 0; tap < kTcnTaps; ++tap) {
      const int source = layer.sources[i * kTcnTaps + static_cast<std::size_t>(tap)];
      for (int env = 0; env < envs_; ++env) {
        if (is_cut(layer.times[i], layer.dilation, tap, env)) continue;
        below.gradient.col(source * envs_ + env) +=
            taps_gradient_.col(static_cast<Eigen::Index>(i) * envs_ + env)
                .segment(tap * rows, rows);
      }
    }
  }
  // The sign of the activated output is the sign of the input.
  below.gradient =
      (below.output.array() > 0)
          .select(below.gradient.array(), kLeakySlope<Scalar> * below.gradient.array());
}

template <typename Scalar>
void Tcn<Scalar>::forward(const std::vector<LayerWeights<Scalar>>& weights,
                          const ConstMatrixRef<Scalar>& memory, const std::uint8_t* reset,
                          std::ptrdiff_t reset_stride) {
  for (int past = 0; past < kTcnPast; ++past) {
    history_.middleCols(past * envs_, envs_) =
        memory.middleRows(past * kProprioceptionSize, kProprioceptionSize);
  }
  find_starts(memory, reset, reset_stride);
  const Matrix<Scalar>* below = &history_;
  for (std::size_t i = 0; i < convolutions_.size(); ++i) {
    Convolution& layer = convolutions_[i];
    gather(*below, layer);
    kernels_->multiply({.samples = static_cast<int>(layer.taps.cols()),
                        .a = rows_of(std::as_const(layer.taps)),
                        .b = weights[i].forward,
                        .c = rows_of(layer.output),
                        .finish = Finish::kLeakyRelu});
    below = &layer.output;
  }
  kernels_->multiply({.samples = steps_ * envs_,
                      .a = rows_of(*below),
                      .b = weights.back().forward,
                      .c = rows_of(output_)});
  apply_tanh(output_);
}

template <typename Scalar>
void Tcn<Scalar>::remember(MatrixRef<Scalar> memory) const {
  for (int past = 0; past < kTcnPast; ++past) {
    memory.middleRows(past * kProprioceptionSize, kProprioceptionSize) =
        history_.middleCols((steps_ + past) * envs_, envs_);
  }
  for (int env = 0; env < envs_; ++env) {
    const int age = steps_ - starts_[static_cast<std::size_t>(steps_ * envs_ + env)];
    memory(kTcnPast * kProprioceptionSize, env) = static_cast<Scalar>(std::min(age, kTcnPast));
  }
}

template <typename Scalar>
void Tcn<Scalar>::backward(const std::vector<LayerWeights<Scalar>>& weights,
                           Matrix<Scalar>& output_gradient, const std::uint8_t* /*reset*/,
                           std::ptrdiff_t /*reset_stride*/, Scalar* gradient) {
  const auto add = [&](const LayerView& view, const Matrix<Scalar>& dy, const Matrix<Scalar>& x) {
    const auto samples = static_cast<int>(x.cols());
    kernels_->add_samples(samples, view.outputs, rows_of(dy), gradient + view.bias);
    kernels_->add_gradient({.samples = samples,
                            .rows = view.outputs,
                            .columns = view.inputs,
                            .a = rows_of(dy),
                            .b = rows_of(x),
                            .c = {gradient + view.weight, view.inputs}});
  };
  dense_gradient_ = before_tanh(output_, output_gradient);
  Convolution& last = convolutions_.back();
  add(layers_.back(), dense_gradient_, last.output);
  kernels_->multiply({.samples = steps_ * envs_,
                      .a = rows_of(std::as_const(dense_gradient_)),
                      .b = weights.back().backward,
                      .c = rows_of(last.gradient),
                      .finish = Finish::kLeakyReluBackward,
                      .activated = rows_of(std::as_const(last.output))});
  for (std::size_t i = convolutions_.size(); i-- > 0;) {
    Convolution& layer = convolutions_[i];
    add(layers_[i], layer.gradient, layer.taps);
    if (i == 0) break;
    taps_gradient_.resize(layer.taps.rows(), layer.taps.cols());
    kernels_->multiply({.samples = static_cast<int>(layer.taps.cols()),
                        .a = rows_of(std::as_const(layer.gradient)),
                        .b = weights[i].backward,
                        .c = rows_of(taps_gradient_)});
    scatter(layer, convolutions_[i - 1]);
  }
}

template class Tcn<float>;
template class Tcn<double>;

}  // namespace sandrunner::learner
