// SPDX-License-Identifier: BSD-3-Clause
// How much each input of an actor changes its answers: integrated gradients (Sundararajan, Taly,
// Yan 2017) and ablation of groups of inputs, both against a reference input.
#pragma once

#include <string>
#include <vector>

#include "rt/base/worker_pool.h"
#include "tools/train/learner/matrix.h"
#include "tools/train/learner/weights.h"

namespace sandrunner::study {

/// Points at which a gradient is taken on the way from the reference to an input.
inline constexpr int kGradientPoints = 64;

/// A multi-layer perceptron with leaky ReLU, as a function of its input (one a column), and its
/// gradient. Owns working memory: one a thread. Same bits on every processor.
class ActorFunction {
 public:
  /// `parameters`: flat array in which the layers lie.
  ActorFunction(const std::vector<learner::LayerView>& layers,
                const std::vector<float>& parameters);

  int inputs() const { return layers_.front().inputs; }
  int outputs() const { return layers_.back().outputs; }

  /// (outputs x n) of (inputs x n).
  const learner::Matrix<float>& answer(const learner::ConstMatrixRef<float>& x);

  /// (outputs x inputs): (x_i - r_i) times the mean of dF/dx_i at kGradientPoints midpoints of the
  /// straight way from the reference r to x. Summed over the inputs: about F(x) - F(r).
  learner::Matrix<float> integrated_gradients(const learner::Vector<float>& x,
                                              const learner::Vector<float>& reference);

 private:
  void add_gradients(int output, float* sum);

  const learner::Kernels<float>* kernels_ = &learner::best_kernels<float>();
  std::vector<learner::LayerView> layers_;
  std::vector<learner::LayerWeights<float>> weights_;
  learner::Matrix<float> output_weights_;            // of the last layer: its inputs x outputs
  std::vector<learner::Matrix<float>> activations_;  // of each layer, one sample a column
  std::vector<learner::Matrix<float>> gradients_;    // of an output by what each layer answers
};

/// Inputs that are replaced by the reference together.
struct InputGroup {
  std::string name;
  int first = 0, count = 0;
};

struct Attribution {
  learner::Vector<float> reference;   ///< mean input
  learner::Vector<double> deviation;  ///< standard deviation of each input over the states
  /// groups x states: mean over the outputs of |F(x) - F(x with the group at the reference)|.
  learner::Matrix<double> ablation;
  /// outputs x inputs: mean over the states of |integrated gradient|.
  learner::Matrix<double> gradients;
  /// Of each state: by how much its integrated gradients miss F(x) - F(reference), both as sums of
  /// magnitudes over the outputs, one over the other.
  std::vector<double> gap;
};

/// `states`: inputs x states. The same bits for any number of threads.
Attribution attribute(const ActorFunction& actor, const learner::Matrix<float>& states,
                      const std::vector<InputGroup>& groups, WorkerPool& pool);

}  // namespace sandrunner::study
