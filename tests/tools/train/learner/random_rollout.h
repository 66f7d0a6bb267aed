// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "tools/train/data/rollout.h"
#include "tools/train/learner/parameters.h"
#include "tools/train/learner/random.h"

namespace sandrunner::learner {

/// Standard normal values in a fixed order.
class NormalSource {
 public:
  explicit NormalSource(std::uint64_t seed) : seed_(seed) {}
  double operator()() {
    return random_normal_pair(seed_, Stream::kInitialization, counter_++, 1).first;
  }

 private:
  std::uint64_t seed_;
  std::uint64_t counter_ = 0;
};

/// A rollout in which every input of the loss is random, as if a policy near the present one had
/// acted, with resets inside the window. The same for every Scalar up to rounding.
template <typename Scalar>
BasicRollout<Scalar> random_rollout(const RolloutShape& shape, int memory) {
  BasicRollout<Scalar> rollout(shape, memory);
  NormalSource normal(7);
  const auto fill = [&](auto matrix, double scale) {
    for (Eigen::Index i = 0; i < matrix.cols(); ++i) {
      for (Eigen::Index k = 0; k < matrix.rows(); ++k) {
        matrix(k, i) = static_cast<Scalar>(static_cast<float>(scale * normal()));
      }
    }
  };
  fill(rollout.initial_memory(0), 0.5);
  // If it ends in the number of observations that count, a TCN's: few, some and all.
  if (memory == kTcnPast * kProprioceptionSize + 1) {
    for (int env = 0; env < shape.envs; ++env) {
      const int observations = env % 3 * kTcnPast / 2;
      rollout.initial_memory(0)(memory - 1, env) = static_cast<Scalar>(observations);
    }
  }
  for (int k = 0; k < kActionSize; ++k) {
    rollout.log_std(k) = static_cast<Scalar>(static_cast<float>(-0.4 + 0.1 * normal()));
  }
  for (int t = 0; t < shape.steps; ++t) {
    fill(rollout.observation(t), 1.0);
    fill(rollout.privileged(t), 1.0);
    fill(rollout.estimate_target(t), 1.0);
    fill(rollout.mean(t), 0.05);
    fill(rollout.symmetric_mean(t), 0.3);
    fill(rollout.insight(t), 1.0);
    fill(rollout.teacher_mean(t), 0.3);
    fill(rollout.teacher_encoding(t), 0.3);
    for (int env = 0; env < shape.envs; ++env) {
      double log_prob = -0.5 * kActionSize * std::log(2.0 * std::numbers::pi);
      for (int k = 0; k < kActionSize; ++k) {
        const double z = normal();
        const auto log_std = static_cast<double>(rollout.log_std(k));
        rollout.action(t)(k, env) = rollout.mean(t)(k, env) +
                                    static_cast<Scalar>(static_cast<float>(z * std::exp(log_std)));
        log_prob -= 0.5 * z * z + log_std;
      }
      rollout.log_prob(t, env) = static_cast<Scalar>(static_cast<float>(log_prob));
      rollout.advantage(t, env) = static_cast<Scalar>(static_cast<float>(normal()));
      rollout.value_target(t, env) = static_cast<Scalar>(static_cast<float>(normal()));
      rollout.reset(t, env) = (t + 2 * env) % 5 == 0 ? 1 : 0;
    }
  }
  return rollout;
}

/// Parameters none of which is small by construction, unlike those at the start of a training.
inline std::vector<double> random_parameters(const ParameterLayout& layout) {
  std::vector<double> parameters;
  const std::vector<float> initial = initial_parameters(layout, 3, 0.6);
  NormalSource normal(11);
  for (const float value : initial) {
    parameters.push_back(static_cast<double>(static_cast<float>(value + 0.15 * normal())));
  }
  return parameters;
}

}  // namespace sandrunner::learner
