// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/experiments/attribution.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace sandrunner::study {
namespace {

using learner::Matrix;
using learner::rows_of;
using learner::Vector;

constexpr int kChunk = 64;  // states of a task

Vector<float> mean_of_columns(const Matrix<float>& states) {
  return states.cast<double>().rowwise().mean().cast<float>();
}

}  // namespace

ActorFunction::ActorFunction(const std::vector<learner::LayerView>& layers,
                             const std::vector<float>& parameters)
    : layers_(layers), activations_(layers.size()) {
  for (const learner::LayerView& layer : layers_) {
    const float* const weight = parameters.data() + layer.weight;
    learner::LayerWeights<float>& packed = weights_.emplace_back(
        learner::LayerWeights<float>{learner::Panels<float>(layer.inputs, layer.outputs),
                                     learner::Panels<float>(layer.outputs, layer.inputs)});
    packed.forward.pack(weight, 1, layer.inputs, parameters.data() + layer.bias);
    packed.backward.pack(weight, layer.inputs, 1);
    gradients_.emplace_back(layer.outputs, kGradientPoints);
  }
  const learner::LayerView& last = layers_.back();
  output_weights_ =
      Eigen::Map<const Matrix<float>>(parameters.data() + last.weight, last.inputs, last.outputs);
}

const Matrix<float>& ActorFunction::answer(const learner::ConstMatrixRef<float>& x) {
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    activations_[i].resize(layers_[i].outputs, x.cols());
    learner::Product<float> product{
        .samples = static_cast<int>(x.cols()),
        .a = i == 0 ? rows_of(x) : rows_of(std::as_const(activations_[i - 1])),
        .b = weights_[i].forward,
        .c = rows_of(activations_[i])};
    if (i + 1 < layers_.size()) product.finish = learner::Finish::kLeakyRelu;
    kernels_->multiply(product);
  }
  return activations_.back();
}

// After `answer`: adds, over the samples, the gradient of an output by what the first layer is made
// of before its activation.
void ActorFunction::add_gradients(int output, float* sum) {
  const std::size_t hidden = layers_.size() - 1;  // layers with an activation
  Matrix<float>& top = gradients_[hidden - 1];
  for (Eigen::Index point = 0; point < top.cols(); ++point) {
    for (Eigen::Index k = 0; k < top.rows(); ++k) {
      const float slope =
          activations_[hidden - 1](k, point) > 0.0f ? 1.0f : learner::kLeakySlope<float>;
      top(k, point) = slope * output_weights_(k, output);
    }
  }
  for (std::size_t i = hidden - 1; i > 0; --i) {
    kernels_->multiply({.samples = kGradientPoints,
                        .a = rows_of(std::as_const(gradients_[i])),
                        .b = weights_[i].backward,
                        .c = rows_of(gradients_[i - 1]),
                        .finish = learner::Finish::kLeakyReluBackward,
                        .activated = rows_of(std::as_const(activations_[i - 1]))});
  }
  kernels_->add_samples(kGradientPoints, layers_.front().outputs,
                        rows_of(std::as_const(gradients_.front())), sum);
}

Matrix<float> ActorFunction::integrated_gradients(const Vector<float>& x,
                                                  const Vector<float>& reference) {
  const Vector<float> way = x - reference;
  Matrix<float> gradients(inputs(), outputs());
  if (layers_.size() == 1) {
    gradients = output_weights_;
  } else {
    Matrix<float> points(inputs(), kGradientPoints);
    for (int k = 0; k < kGradientPoints; ++k) {
      const float share = (static_cast<float>(k) + 0.5f) / kGradientPoints;
      points.col(k) = reference + share * way;
    }
    answer(points);
    Matrix<float> of_first = Matrix<float>::Zero(layers_.front().outputs, outputs());
    for (int output = 0; output < outputs(); ++output) {
      add_gradients(output, of_first.col(output).data());
    }
    of_first *= 1.0f / kGradientPoints;
    kernels_->multiply({.samples = outputs(),
                        .a = rows_of(std::as_const(of_first)),
                        .b = weights_.front().backward,
                        .c = rows_of(gradients)});
  }
  return (gradients.array().colwise() * way.array()).matrix().transpose();
}

Attribution attribute(const ActorFunction& actor, const Matrix<float>& states,
                      const std::vector<InputGroup>& groups, WorkerPool& pool) {
  const Eigen::Index count = states.cols();
  Attribution result;
  result.reference = mean_of_columns(states);
  const Matrix<double> off = states.cast<double>().colwise() - result.reference.cast<double>();
  result.deviation = (off.array().square().rowwise().mean()).sqrt();
  result.ablation.resize(static_cast<Eigen::Index>(groups.size()), count);
  result.gap.resize(static_cast<std::size_t>(count));
  std::vector<ActorFunction> actors(static_cast<std::size_t>(pool.threads()), actor);
  const auto chunks = static_cast<int>((count + kChunk - 1) / kChunk);
  std::vector<Matrix<double>> sums(static_cast<std::size_t>(chunks));  // of |gradients|
  pool.run(chunks, [&](int chunk, int worker) {
    ActorFunction& f = actors[static_cast<std::size_t>(worker)];
    const Eigen::Index first = Eigen::Index{chunk} * kChunk;
    const Eigen::Index n = std::min<Eigen::Index>(kChunk, count - first);
    const Matrix<float> x = states.middleCols(first, n);
    const Matrix<float> at_reference = f.answer(result.reference);
    const Matrix<float> whole = f.answer(x);
    for (std::size_t g = 0; g < groups.size(); ++g) {
      Matrix<float> ablated = x;
      ablated.middleRows(groups[g].first, groups[g].count).colwise() =
          result.reference.segment(groups[g].first, groups[g].count);
      const Matrix<double> difference = (f.answer(ablated) - whole).cast<double>();
      result.ablation.row(static_cast<Eigen::Index>(g)).segment(first, n) =
          difference.cwiseAbs().colwise().mean();
    }
    Matrix<double>& sum = sums[static_cast<std::size_t>(chunk)];
    sum.setZero(f.outputs(), f.inputs());
    for (Eigen::Index k = 0; k < n; ++k) {
      const Matrix<double> gradients =
          f.integrated_gradients(x.col(k), result.reference).cast<double>();
      sum += gradients.cwiseAbs();
      const Vector<double> change = (whole.col(k) - at_reference.col(0)).cast<double>();
      result.gap[static_cast<std::size_t>(first + k)] =
          (gradients.rowwise().sum() - change).cwiseAbs().sum() / change.cwiseAbs().sum();
    }
  });
  result.gradients.setZero(actor.outputs(), actor.inputs());
  for (const Matrix<double>& sum : sums) result.gradients += sum;
  result.gradients /= static_cast<double>(count);
  return result;
}

}  // namespace sandrunner::study
