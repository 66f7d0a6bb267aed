// SPDX-License-Identifier: BSD-3-Clause
// The data of one window: what the environments write, what the networks answer, what the update
// needs.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "policy/wiring.h"
#include "rt/core/messages.h"

namespace sandrunner::learner {

struct RolloutShape {
  int envs = 0;        ///< environments
  int steps = 32;      ///< of a window; the length of back-propagation through time
  int privileged = 0;  ///< size of the critic's input
  int insight = 0;     ///< kInsightSize, if a network sees it
  int teacher = 0;     ///< size of the encoding of the teacher that the policy imitates, if any
};

/// How a step left the episode. A terminated episode has no future reward; after a timeout the
/// future is worth what the critic says of `final_privileged`. Both cut the advantage; neither
/// clears the policy's memory (`reset` does).
enum class End : std::uint8_t { kNone, kTerminated, kTimeout };

/// A vector for every step and environment; (t) is a matrix with one environment a column.
template <typename Scalar, int kRows>
class VectorField {
 public:
  VectorField(int rows, int envs, int steps) : envs_(envs), data_(rows, envs * steps) {
    data_.setZero();
  }
  /// All of it: step by step, in each the environments.
  std::span<std::byte> bytes() {
    return std::as_writable_bytes(std::span(data_.data(), static_cast<std::size_t>(data_.size())));
  }
  auto operator()(int t) { return data_.middleCols(t * envs_, envs_); }
  auto operator()(int t) const { return data_.middleCols(t * envs_, envs_); }

 private:
  int envs_;
  Eigen::Matrix<Scalar, kRows, Eigen::Dynamic> data_;
};

/// A value for every step and environment.
template <typename T>
class ValueField {
 public:
  ValueField(int envs, int steps)
      : envs_(envs), data_(static_cast<std::size_t>(envs) * static_cast<std::size_t>(steps)) {}
  /// All of it: step by step, in each the environments.
  std::span<std::byte> bytes() { return std::as_writable_bytes(std::span(data_)); }
  T& operator()(int t, int env) { return data_[index(t, env)]; }
  const T& operator()(int t, int env) const { return data_[index(t, env)]; }

 private:
  std::size_t index(int t, int env) const {
    return static_cast<std::size_t>(t) * static_cast<std::size_t>(envs_) +
           static_cast<std::size_t>(env);
  }
  int envs_;
  std::vector<T> data_;
};

template <typename Scalar>
struct BasicRollout {
  /// `memory`: rows of the policy's memory (ParameterLayout::memory).
  BasicRollout(const RolloutShape& rollout_shape, int memory)
      : shape(rollout_shape),
        observation(kObservationSize, shape.envs, shape.steps + 1),
        privileged(shape.privileged, shape.envs, shape.steps + 1),
        estimate_target(kEstimateSize, shape.envs, shape.steps + 1),
        insight(shape.insight, shape.envs, shape.steps + 1),
        reset(shape.envs, shape.steps + 1),
        reward(shape.envs, shape.steps),
        end(shape.envs, shape.steps),
        final_privileged(shape.privileged, shape.envs, shape.steps),
        action(kNumJoints, shape.envs, shape.steps),
        mean(kNumJoints, shape.envs, shape.steps),
        symmetric_mean(kNumJoints, shape.envs, shape.steps),
        teacher_mean(shape.teacher > 0 ? kNumJoints : 0, shape.envs, shape.steps),
        teacher_encoding(shape.teacher, shape.envs, shape.steps),
        log_prob(shape.envs, shape.steps),
        value(shape.envs, shape.steps + 1),
        timeout_value(shape.envs, shape.steps),
        initial_memory(memory, shape.envs, 1),
        log_std(Eigen::Matrix<Scalar, Eigen::Dynamic, 1>::Zero(kNumJoints)),
        advantage(shape.envs, shape.steps),
        value_target(shape.envs, shape.steps) {}

  RolloutShape shape;

  // Written by the environments: before step t ...
  /// [command 3 | proprioception 30], normalised and clipped.
  VectorField<Scalar, kObservationSize> observation;
  /// Input of the critic, normalised.
  VectorField<Scalar, Eigen::Dynamic> privileged;
  /// What the estimator should answer to observation(t), in units of its raw output.
  VectorField<Scalar, kEstimateSize> estimate_target;
  /// What networks of a study see; no rows without one.
  VectorField<Scalar, Eigen::Dynamic> insight;
  /// 1: the policy's memory is cleared before step t, because the robot was set up anew; else 0.
  ValueField<std::uint8_t> reset;
  // ... and after it.
  ValueField<Scalar> reward;
  ValueField<End> end;
  /// Only for End::kTimeout: input of the critic in the state in which the episode was cut.
  VectorField<Scalar, Eigen::Dynamic> final_privileged;

  // Written when the policy acts.
  VectorField<Scalar, kNumJoints> action;  ///< sampled, in network units
  VectorField<Scalar, kNumJoints> mean;
  /// `mean` without what has long been different in the mirror (LearnerConfig::symmetry_steps):
  /// `mean` itself, if the policy is symmetric. Zero without a symmetry.
  VectorField<Scalar, kNumJoints> symmetric_mean;
  /// What the teacher answers, and its encoding; no rows without one.
  VectorField<Scalar, Eigen::Dynamic> teacher_mean;
  VectorField<Scalar, Eigen::Dynamic> teacher_encoding;
  ValueField<Scalar> log_prob;
  ValueField<Scalar> value;
  /// Only for End::kTimeout: the critic's value of `final_privileged`. Written before the update.
  ValueField<Scalar> timeout_value;

  // Of the window as a whole: the policy's memory before step 0, and its log standard deviations.
  VectorField<Scalar, Eigen::Dynamic> initial_memory;
  Eigen::Matrix<Scalar, Eigen::Dynamic, 1> log_std;

  // Written by compute_gae.
  ValueField<Scalar> advantage;
  ValueField<Scalar> value_target;

  /// The state after the window of these environments becomes that before the next one.
  void begin_next(int first_env, int envs) {
    const auto carry = [&](auto&... fields) {
      ((fields(0).middleCols(first_env, envs) = fields(shape.steps).middleCols(first_env, envs)),
       ...);
    };
    carry(observation, privileged, estimate_target, insight);
    for (int env = first_env; env < first_env + envs; ++env)
      reset(0, env) = reset(shape.steps, env);
  }

  /// Calls visit(bytes of a field, its steps) for each field that an update needs of a window that
  /// has been valued, or that the next window begins with.
  template <typename Visit>
  void for_each_learnt(const Visit& visit) {
    const auto each = [&](int steps, auto&... fields) { (visit(fields.bytes(), steps), ...); };
    each(shape.steps + 1, observation, privileged, estimate_target, insight, reset);
    each(shape.steps, action, mean, symmetric_mean, teacher_mean, teacher_encoding, log_prob,
         advantage, value_target);
    each(1, initial_memory);
  }
};

using Rollout = BasicRollout<float>;

}  // namespace sandrunner::learner
