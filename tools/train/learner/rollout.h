// SPDX-License-Identifier: BSD-3-Clause
// The data of one window: what the environments write, what the networks answer, what the update
// needs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tools/train/learner/matrix.h"
#include "tools/train/learner/parameters.h"

namespace sandrunner::learner {

struct RolloutShape {
  int envs = 0;        ///< environments
  int steps = 32;      ///< of a window; the length of back-propagation through time
  int privileged = 0;  ///< size of the critic's input
};

/// How a step left the episode. A terminated episode has no future reward; after a timeout the
/// future is worth `timeout_value`. Both cut the advantage; neither clears the policy's memory
/// (Learner::reset_memory does).
enum class End : std::uint8_t { kNone, kTerminated, kTimeout };

/// A vector for every step and environment; (t) is a matrix with one environment a column.
template <typename Scalar, int kRows>
class VectorField {
 public:
  VectorField(int rows, int envs, int steps) : envs_(envs), data_(rows, envs * steps) {
    data_.setZero();
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
  BasicRollout(const RolloutShape& rollout_shape, int hidden)
      : shape(rollout_shape),
        observation(kObservationSize, shape.envs, shape.steps + 1),
        privileged(shape.privileged, shape.envs, shape.steps + 1),
        estimate_target(kEstimateSize, shape.envs, shape.steps + 1),
        reward(shape.envs, shape.steps),
        end(shape.envs, shape.steps),
        timeout_value(shape.envs, shape.steps),
        action(kActionSize, shape.envs, shape.steps),
        mean(kActionSize, shape.envs, shape.steps),
        mirror_mean(kActionSize, shape.envs, shape.steps),
        log_prob(shape.envs, shape.steps),
        value(shape.envs, shape.steps + 1),
        reset(shape.envs, shape.steps),
        initial_h(hidden, shape.envs, 1),
        initial_c(hidden, shape.envs, 1),
        log_std(Vector<Scalar>::Zero(kActionSize)),
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
  // ... and after it.
  ValueField<Scalar> reward;
  ValueField<End> end;
  /// Only for End::kTimeout: value of the state in which the episode was cut (Learner::value).
  ValueField<Scalar> timeout_value;

  // Written by Learner::act_block.
  VectorField<Scalar, kActionSize> action;  ///< sampled, in network units
  VectorField<Scalar, kActionSize> mean;
  /// Mirror image of the policy's answer to the mirror image of the observations: `mean`, if the
  /// policy is symmetric. Zero without a symmetry.
  VectorField<Scalar, kActionSize> mirror_mean;
  ValueField<Scalar> log_prob;
  ValueField<Scalar> value;
  ValueField<std::uint8_t> reset;  ///< memory was cleared before step t

  // Of the window as a whole: the policy's memory before step 0, and its log standard deviations.
  VectorField<Scalar, Eigen::Dynamic> initial_h;
  VectorField<Scalar, Eigen::Dynamic> initial_c;
  Vector<Scalar> log_std;

  // Written by compute_gae.
  ValueField<Scalar> advantage;
  ValueField<Scalar> value_target;
};

using Rollout = BasicRollout<float>;

}  // namespace sandrunner::learner
