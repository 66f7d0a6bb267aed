// SPDX-License-Identifier: BSD-3-Clause
// The networks as they work together, and the loss with its gradient over a block of environments.
#pragma once

#include <array>
#include <cstdint>
#include <variant>

#include "tools/train/data/rollout.h"
#include "tools/train/learner/insight_encoder.h"
#include "tools/train/learner/lstm.h"
#include "tools/train/learner/matrix.h"
#include "tools/train/learner/mlp.h"
#include "tools/train/learner/parameters.h"
#include "tools/train/learner/tcn.h"
#include "tools/train/learner/weights.h"

namespace sandrunner::learner {

/// loss = mean over samples of
///   -policy_weight min(ratio A, clip(ratio, 1 - clip, 1 + clip) A) + value_weight (V - R)^2 / 2
///   + estimate_weight mean_8((estimate - target)^2) - entropy_weight entropy
///   + symmetry_weight |(mean - symmetric mean) / std of the policy that acted|^2 / 2
///   + imitation_weight |mean - teacher's mean|^2 / 12
///   + encoding_weight |h - teacher's h|^2 / size of h
/// with the symmetric mean as Learner makes it: the mean of the policy that acted less what it
/// differs from its mirror image by, averaged over LearnerConfig::symmetry_steps.
struct LossConfig {
  double clip = 0.2;
  double value_weight = 1.0;
  double estimate_weight = 1.0;
  double entropy_weight = 0.0;
  double symmetry_weight = 0.0;  ///< only with a symmetry
  double policy_weight = 1.0;
  double imitation_weight = 0.0;  ///< only with a teacher, as the next
  double encoding_weight = 0.0;
};

/// A = (advantage - mean) inverse_std.
struct AdvantageScale {
  double mean = 0.0;
  double inverse_std = 1.0;
};

/// Sums over samples (steps x environments), all double (rt/base/add_members.h).
struct LossSums {
  double policy = 0.0;
  double value = 0.0;  ///< (V - R)^2 / 2
  std::array<double, kEstimateSize> estimate_square{};
  double kl = 0.0;  ///< of the new policy from the one that acted, exact
  double clipped = 0.0;
  double asymmetry = 0.0;  ///< |(mean - symmetric mean) / std|^2 / 2
  double imitation = 0.0;  ///< |mean - teacher's mean|^2 / 12
  double encoding = 0.0;   ///< |h - teacher's h|^2 / size of h
  double samples = 0.0;
};

/// Working memory and wiring of all networks for a block of environments: the encoder over `steps`
/// steps, the heads over chunks of columns. Instantiated for float (training) and double (tests).
///   encoder: proprioception, or the insight of a teacher -> h
///   estimator: h -> estimate;  critic: privileged -> value
///   actor: [command | h | estimate], or what else of ActorInputs it sees -> mean of the action. No
///   gradient flows from the actor into the estimate.
template <typename Scalar>
class BlockPass {
 public:
  /// The heads work on chunk_steps * envs columns at a time: few enough to stay in the cache.
  BlockPass(const ParameterLayout& layout, int steps, int envs, int chunk_steps,
            const Kernels<Scalar>& kernels = best_kernels<Scalar>());

  /// One step of acting: fills mean, value of rollout step t for the block, and carries its memory
  /// (ParameterLayout::memory() x envs) on. The block has one step (constructor).
  void act(const Weights<Scalar>& weights, BasicRollout<Scalar>& rollout, int t, int first_env,
           MatrixRef<Scalar> memory);

  /// What the policy, with this memory, answers to observations (33 x envs) and, if it sees it,
  /// insight (22 x envs); -> mean (12 x envs).
  void answer(const Weights<Scalar>& weights, const ConstMatrixRef<Scalar>& observation,
              const ConstMatrixRef<Scalar>& insight, const std::uint8_t* reset,
              MatrixRef<Scalar> memory, MatrixRef<Scalar> mean);
  /// Encoding h (hidden x envs) and estimate (8 x envs) of the answer.
  const Matrix<Scalar>& encoding() const;
  auto estimate() const { return estimator_.output(envs_); }
  /// What the actor saw in it (ParameterLayout::actor_inputs() x envs): the parts of ActorInputs in
  /// the order of parameters.h.
  auto actor_input() const { return actor_input_.leftCols(envs_); }

  /// The critic's values of rollout step t; `steps` is the state after the window.
  void evaluate(const Weights<Scalar>& weights, BasicRollout<Scalar>& rollout, int t,
                int first_env);

  /// Value of one privileged vector.
  Scalar value(const Weights<Scalar>& weights, const Scalar* privileged);

  /// Loss of the window of the block's environments; adds its gradient, divided by `samples` (the
  /// number of samples in the whole minibatch), to `gradient`.
  LossSums loss_and_gradient(const Weights<Scalar>& weights, const BasicRollout<Scalar>& rollout,
                             int first_env, const LossConfig& config, const AdvantageScale& scale,
                             int samples, Scalar* gradient);

 private:
  using Encoder = std::variant<Lstm<Scalar>, Tcn<Scalar>, InsightEncoder<Scalar>>;
  static Encoder make_encoder(const ParameterLayout& layout, int steps, int envs,
                              const Kernels<Scalar>& kernels);

  /// Columns of what the actor sees, from `first` on: data of one step, and answers.
  void set_data(int first, const ConstMatrixRef<Scalar>& observation,
                const ConstMatrixRef<Scalar>& insight);
  template <typename Encoding, typename Estimate>
  void set_answers(const Encoding& h, const Estimate& estimate);

  /// Fills actor_input_ and critic_input_ and runs the heads for rollout steps t ... t + steps,
  /// whose encoder outputs begin with step `window_step` of the encoder.
  void run_heads(const Weights<Scalar>& weights, const BasicRollout<Scalar>& rollout, int t,
                 int steps, int first_env, int window_step);
  /// Fills the output gradients of the heads and adds that of log_std.
  void differentiate_loss(const Weights<Scalar>& weights, const BasicRollout<Scalar>& rollout,
                          int t, int steps, int first_env, const LossConfig& config,
                          const AdvantageScale& scale, int samples, LossSums& sums,
                          Scalar* gradient);

  /// With a teacher, after `differentiate_loss`: adds to the gradients of the actor's output and of
  /// the encoding.
  void differentiate_imitation(const BasicRollout<Scalar>& rollout, int t, int steps, int first_env,
                               const LossConfig& config, int samples, LossSums& sums);

  ParameterLayout layout_;
  int steps_;
  int envs_;
  int chunk_steps_;
  Encoder encoder_;
  Mlp<Scalar> estimator_;
  Mlp<Scalar> actor_;
  Mlp<Scalar> critic_;
  /// Rows of actor_input_ at which its parts begin.
  int estimate_row_, proprioception_row_, terrain_row_;
  Matrix<Scalar> actor_input_;
  Matrix<Scalar> critic_input_;
  Matrix<Scalar> output_gradient_;  // of the encoder
};

/// Entropy of the policy's normal distribution; log_std: 12 values.
template <typename Scalar>
double entropy(const Scalar* log_std);

}  // namespace sandrunner::learner
