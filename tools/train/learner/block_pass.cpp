// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/learner/block_pass.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sandrunner::learner {

template <typename Scalar>
double entropy(const Scalar* log_std) {
  double sum = 0.5 * kActionSize * (1.0 + std::log(2.0 * std::numbers::pi));
  for (int k = 0; k < kActionSize; ++k) sum += static_cast<double>(log_std[k]);
  return sum;
}
template double entropy(const float* log_std);
template double entropy(const double* log_std);

template <typename Scalar>
BlockPass<Scalar>::BlockPass(const ParameterLayout& layout, int steps, int envs, int chunk_steps,
                             const Kernels<Scalar>& kernels)
    : layout_(layout),
      steps_(steps),
      envs_(envs),
      chunk_steps_(chunk_steps),
      encoder_(make_encoder(layout, steps, envs, kernels)),
      estimator_(layout.estimator(), chunk_steps * envs, kernels),
      actor_(layout.actor(), chunk_steps * envs, kernels),
      critic_(layout.critic(), chunk_steps * envs, kernels),
      estimate_row_(kCommandSize +
                    (layout.sizes().wiring.actor_sees.encoding ? layout.hidden() : 0)),
      proprioception_row_(estimate_row_ +
                          (layout.sizes().wiring.actor_sees.estimate ? kEstimateSize : 0)),
      terrain_row_(proprioception_row_ +
                   (layout.sizes().wiring.actor_sees.proprioception ? kProprioceptionSize : 0)),
      actor_input_(layout.actor_inputs(), chunk_steps * envs),
      critic_input_(layout.privileged(), chunk_steps * envs),
      output_gradient_(layout.hidden(), steps * envs) {}

template <typename Scalar>
typename BlockPass<Scalar>::Encoder BlockPass<Scalar>::make_encoder(
    const ParameterLayout& layout, int steps, int envs, const Kernels<Scalar>& kernels) {
  switch (layout.sizes().wiring.encoder) {
    case EncoderKind::kTcn:
      return Tcn<Scalar>(layout, steps, envs, kernels);
    case EncoderKind::kInsight:
      return InsightEncoder<Scalar>(layout, steps, envs, kernels);
    case EncoderKind::kLstm:
      break;
  }
  return Lstm<Scalar>(layout, steps, envs, kernels);
}

template <typename Scalar>
const Matrix<Scalar>& BlockPass<Scalar>::encoding() const {
  return std::visit([](const auto& e) -> const Matrix<Scalar>& { return e.output(); }, encoder_);
}

template <typename Scalar>
void BlockPass<Scalar>::set_data(int first, const ConstMatrixRef<Scalar>& observation,
                                 const ConstMatrixRef<Scalar>& insight) {
  const ActorInputs& sees = layout_.sizes().wiring.actor_sees;
  actor_input_.block(0, first, kCommandSize, envs_) = observation.topRows(kCommandSize);
  if (sees.proprioception) {
    actor_input_.block(proprioception_row_, first, kProprioceptionSize, envs_) =
        observation.bottomRows(kProprioceptionSize);
  }
  if (sees.terrain) {
    actor_input_.block(terrain_row_, first, kTerrainSize, envs_) = insight.topRows(kTerrainSize);
  }
}

template <typename Scalar>
template <typename Encoding, typename Estimate>
void BlockPass<Scalar>::set_answers(const Encoding& h, const Estimate& estimate) {
  const ActorInputs& sees = layout_.sizes().wiring.actor_sees;
  if (sees.encoding) actor_input_.block(kCommandSize, 0, h.rows(), h.cols()) = h;
  if (sees.estimate) {
    actor_input_.block(estimate_row_, 0, kEstimateSize, estimate.cols()) = estimate;
  }
}

template <typename Scalar>
void BlockPass<Scalar>::run_heads(const Weights<Scalar>& weights,
                                  const BasicRollout<Scalar>& rollout, int t, int steps,
                                  int first_env, int window_step) {
  const int n = steps * envs_;
  const auto h = encoding().middleCols(window_step * envs_, n);
  estimator_.forward(weights.estimator(), h);
  for (int k = 0; k < steps; ++k) {
    set_data(k * envs_, rollout.observation(t + k).middleCols(first_env, envs_),
             rollout.insight(t + k).middleCols(first_env, envs_));
    critic_input_.middleCols(k * envs_, envs_) =
        rollout.privileged(t + k).middleCols(first_env, envs_);
  }
  set_answers(h, estimator_.output(n));
  actor_.forward(weights.actor(), actor_input_.leftCols(n));
  critic_.forward(weights.critic(), critic_input_.leftCols(n));
}

template <typename Scalar>
void BlockPass<Scalar>::act(const Weights<Scalar>& weights, BasicRollout<Scalar>& rollout, int t,
                            int first_env, MatrixRef<Scalar> memory) {
  answer(weights, rollout.observation(t).middleCols(first_env, envs_),
         rollout.insight(t).middleCols(first_env, envs_), &rollout.reset(t, first_env), memory,
         rollout.mean(t).middleCols(first_env, envs_));
  evaluate(weights, rollout, t, first_env);
}

template <typename Scalar>
void BlockPass<Scalar>::answer(const Weights<Scalar>& weights,
                               const ConstMatrixRef<Scalar>& observation,
                               const ConstMatrixRef<Scalar>& insight, const std::uint8_t* reset,
                               MatrixRef<Scalar> memory, MatrixRef<Scalar> mean) {
  std::visit(
      [&](auto& encoder) {
        encoder.set_input(0, observation, insight);
        encoder.forward(weights.encoder(), memory, reset, 0);
        encoder.remember(memory);
      },
      encoder_);
  estimator_.forward(weights.estimator(), encoding());
  set_data(0, observation, insight);
  set_answers(encoding(), estimate());
  actor_.forward(weights.actor(), actor_input_.leftCols(envs_));
  mean = actor_.output(envs_);
}

template <typename Scalar>
void BlockPass<Scalar>::evaluate(const Weights<Scalar>& weights, BasicRollout<Scalar>& rollout,
                                 int t, int first_env) {
  critic_.forward(weights.critic(), rollout.privileged(t).middleCols(first_env, envs_));
  for (int env = 0; env < envs_; ++env) {
    rollout.value(t, first_env + env) = critic_.output(envs_)(0, env);
  }
}

template <typename Scalar>
Scalar BlockPass<Scalar>::value(const Weights<Scalar>& weights, const Scalar* privileged) {
  critic_.forward(weights.critic(),
                  Eigen::Map<const Matrix<Scalar>>(privileged, layout_.privileged(), 1));
  return critic_.output(1)(0, 0);
}

template <typename Scalar>
LossSums BlockPass<Scalar>::loss_and_gradient(const Weights<Scalar>& weights,
                                              const BasicRollout<Scalar>& rollout, int first_env,
                                              const LossConfig& config, const AdvantageScale& scale,
                                              int samples, Scalar* gradient) {
  const std::uint8_t* reset = &rollout.reset(0, first_env);
  std::visit(
      [&](auto& encoder) {
        for (int t = 0; t < steps_; ++t) {
          encoder.set_input(t, rollout.observation(t).middleCols(first_env, envs_),
                            rollout.insight(t).middleCols(first_env, envs_));
        }
        encoder.forward(weights.encoder(), rollout.initial_memory(0).middleCols(first_env, envs_),
                        reset, rollout.shape.envs);
      },
      encoder_);
  LossSums sums;
  output_gradient_.setZero();
  for (int t = 0; t < steps_; t += chunk_steps_) {
    const int steps = std::min(chunk_steps_, steps_ - t);
    const int n = steps * envs_;
    run_heads(weights, rollout, t, steps, first_env, t);
    differentiate_loss(weights, rollout, t, steps, first_env, config, scale, samples, sums,
                       gradient);
    if (rollout.shape.teacher > 0) {
      differentiate_imitation(rollout, t, steps, first_env, config, samples, sums);
    }
    critic_.backward(weights.critic(), critic_input_.leftCols(n), gradient);
    actor_.backward(weights.actor(), actor_input_.leftCols(n), gradient);
    estimator_.backward(weights.estimator(), encoding().middleCols(t * envs_, n), gradient);
    // Of the actor's inputs only h: others are data, the estimate is detached.
    auto dh = output_gradient_.middleCols(t * envs_, n);
    if (layout_.sizes().wiring.actor_sees.encoding) actor_.add_input_gradient(weights.actor(), dh);
    estimator_.add_input_gradient(weights.estimator(), dh);
  }
  std::visit(
      [&](auto& encoder) {
        encoder.backward(weights.encoder(), output_gradient_, reset, rollout.shape.envs, gradient);
      },
      encoder_);
  return sums;
}

template <typename Scalar>
void BlockPass<Scalar>::differentiate_loss(const Weights<Scalar>& weights,
                                           const BasicRollout<Scalar>& rollout, int t, int steps,
                                           int first_env, const LossConfig& config,
                                           const AdvantageScale& scale, int samples, LossSums& sums,
                                           Scalar* gradient) {
  const int n = steps * envs_;
  const Scalar inverse_samples = Scalar(1) / static_cast<Scalar>(samples);
  const auto clip = static_cast<Scalar>(config.clip);
  const auto policy_factor = static_cast<Scalar>(config.policy_weight) * inverse_samples;
  const auto value_factor = static_cast<Scalar>(config.value_weight) * inverse_samples;
  const auto estimate_factor =
      static_cast<Scalar>(config.estimate_weight * 2.0 / kEstimateSize) * inverse_samples;
  const Scalar* log_std = weights.log_std().data();
  std::array<Scalar, kActionSize> inverse_std{};
  std::array<Scalar, kActionSize> log_std_gradient{};
  std::array<Scalar, kActionSize> kl_variance{};  // old variance / new variance
  std::array<Scalar, kActionSize> inverse_old_std{};
  const auto symmetry_factor = static_cast<Scalar>(config.symmetry_weight) * inverse_samples;
  Scalar log_norm = static_cast<Scalar>(-0.5 * kActionSize * std::log(2.0 * std::numbers::pi));
  Scalar kl_constant = 0;
  for (std::size_t k = 0; k < kActionSize; ++k) {
    inverse_std[k] = std::exp(-log_std[k]);
    inverse_old_std[k] = std::exp(-rollout.log_std(static_cast<Eigen::Index>(k)));
    log_norm -= log_std[k];
    const Scalar log_ratio = rollout.log_std(static_cast<Eigen::Index>(k)) - log_std[k];
    kl_variance[k] = std::exp(2 * log_ratio);
    kl_constant += static_cast<Scalar>(0.5) * (kl_variance[k] - 1) - log_ratio;
  }
  const auto means = actor_.output(n);
  const auto values = critic_.output(n);
  const auto estimates = estimator_.output(n);
  auto mean_gradient = actor_.output_gradient(n);
  auto value_gradient = critic_.output_gradient(n);
  auto estimate_gradient = estimator_.output_gradient(n);

  for (int column = 0; column < n; ++column) {
    const int step = t + column / envs_;
    const int env = first_env + column % envs_;

    const auto mean = means.col(column);
    const auto action = rollout.action(step).col(env);
    const auto old_mean = rollout.mean(step).col(env);
    std::array<Scalar, kActionSize> z{};
    Scalar square = 0;
    Scalar shift_square = 0;
    for (int k = 0; k < kActionSize; ++k) {
      const auto i = static_cast<std::size_t>(k);
      z[i] = (action(k) - mean(k)) * inverse_std[i];
      square += z[i] * z[i];
      const Scalar shift = (old_mean(k) - mean(k)) * inverse_std[i];
      shift_square += shift * shift;
    }
    const Scalar log_prob = log_norm - static_cast<Scalar>(0.5) * square;
    const Scalar ratio = std::exp(log_prob - rollout.log_prob(step, env));
    const Scalar advantage = (rollout.advantage(step, env) - static_cast<Scalar>(scale.mean)) *
                             static_cast<Scalar>(scale.inverse_std);
    const Scalar bounded = std::clamp(ratio, 1 - clip, 1 + clip);
    const bool is_clipped = bounded * advantage < ratio * advantage;
    sums.policy -= static_cast<double>((is_clipped ? bounded : ratio) * advantage);
    sums.clipped += is_clipped ? 1.0 : 0.0;
    sums.kl += static_cast<double>(kl_constant + static_cast<Scalar>(0.5) * shift_square);
    Scalar asymmetry = 0;
    const Scalar log_prob_gradient = is_clipped ? Scalar(0) : -advantage * ratio * policy_factor;
    for (int k = 0; k < kActionSize; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const Scalar lopsided = (mean(k) - rollout.symmetric_mean(step)(k, env)) * inverse_old_std[i];
      asymmetry += lopsided * lopsided;
      mean_gradient(k, column) = log_prob_gradient * z[i] * inverse_std[i] +
                                 symmetry_factor * lopsided * inverse_old_std[i];
      log_std_gradient[i] += log_prob_gradient * (z[i] * z[i] - 1);
    }

    sums.asymmetry += 0.5 * static_cast<double>(asymmetry);

    const Scalar value_error = values(0, column) - rollout.value_target(step, env);
    sums.value += 0.5 * static_cast<double>(value_error * value_error);
    value_gradient(0, column) = value_factor * value_error;

    const auto target = rollout.estimate_target(step).col(env);
    for (int k = 0; k < kEstimateSize; ++k) {
      const Scalar error = estimates(k, column) - target(k);
      sums.estimate_square[static_cast<std::size_t>(k)] += static_cast<double>(error * error);
      estimate_gradient(k, column) = estimate_factor * error;
    }
  }
  sums.samples += n;
  // The entropy grows by one with each log_std.
  const auto entropy_gradient =
      static_cast<Scalar>(config.entropy_weight) * inverse_samples * static_cast<Scalar>(n);
  for (std::size_t k = 0; k < kActionSize; ++k) {
    gradient[layout_.log_std() + static_cast<std::ptrdiff_t>(k)] +=
        log_std_gradient[k] - entropy_gradient;
  }
}

template <typename Scalar>
void BlockPass<Scalar>::differentiate_imitation(const BasicRollout<Scalar>& rollout, int t,
                                                int steps, int first_env, const LossConfig& config,
                                                int samples, LossSums& sums) {
  const int hidden = layout_.hidden();
  const auto mean_factor =
      static_cast<Scalar>(config.imitation_weight * 2.0 / kActionSize / samples);
  const auto encoding_factor = static_cast<Scalar>(config.encoding_weight * 2.0 / hidden / samples);
  for (int k = 0; k < steps; ++k) {
    const Matrix<Scalar> off = actor_.output(steps * envs_).middleCols(k * envs_, envs_) -
                               rollout.teacher_mean(t + k).middleCols(first_env, envs_);
    const Matrix<Scalar> encoding_off =
        encoding().middleCols((t + k) * envs_, envs_) -
        rollout.teacher_encoding(t + k).middleCols(first_env, envs_);
    sums.imitation += static_cast<double>(off.squaredNorm()) / kActionSize;
    sums.encoding += static_cast<double>(encoding_off.squaredNorm()) / hidden;
    actor_.output_gradient(steps * envs_).middleCols(k * envs_, envs_) += mean_factor * off;
    output_gradient_.middleCols((t + k) * envs_, envs_) += encoding_factor * encoding_off;
  }
}

template class BlockPass<float>;
template class BlockPass<double>;

}  // namespace sandrunner::learner
