// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "tools/train/kernels/panels.h"
#include "tools/train/learner/parameters.h"

namespace sandrunner::learner {

/// The weights of a layer, packed for the products with samples.
template <typename Scalar>
struct LayerWeights {
  Panels<Scalar> forward;   ///< W^T, starting from the bias: x -> y
  Panels<Scalar> backward;  ///< W: dy -> dx, of those inputs whose gradient is asked for
};

/// All networks' weights as the passes use them: packed once for all the samples of a minibatch,
/// and shared by the threads.
template <typename Scalar>
class Weights {
 public:
  explicit Weights(const ParameterLayout& layout);

  /// parameters: the flat array of the layout.
  void set(const Scalar* parameters);

  /// LSTM: one matrix [W_ih | bias | W_hh]; backwards to h. Others: their layers; not back to the
  /// inputs.
  const std::vector<LayerWeights<Scalar>>& encoder() const { return encoder_; }
  /// Backwards to h.
  const std::vector<LayerWeights<Scalar>>& estimator() const { return estimator_; }
  /// Backwards to h, if that is among its inputs.
  const std::vector<LayerWeights<Scalar>>& actor() const { return actor_; }
  /// Not back to its inputs, which are data.
  const std::vector<LayerWeights<Scalar>>& critic() const { return critic_; }
  /// Logarithms of the standard deviations of the actions.
  const std::vector<Scalar>& log_std() const { return log_std_; }

 private:
  ParameterLayout layout_;
  std::vector<LayerWeights<Scalar>> encoder_;
  std::vector<LayerWeights<Scalar>> estimator_;
  std::vector<LayerWeights<Scalar>> actor_;
  std::vector<LayerWeights<Scalar>> critic_;
  std::vector<Scalar> log_std_;
};

}  // namespace sandrunner::learner
