// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/learner/gae.h"

#include <gtest/gtest.h>

#include "tools/train/learner/random.h"

namespace sandrunner::learner {
namespace {

/// The definition: the sum over k of (gamma lambda)^k delta(t + k) up to the end of the episode or
/// window.
double advantage_by_definition(const Rollout& rollout, int t, int env, double gamma,
                               double lambda) {
  double sum = 0.0;
  double weight = 1.0;
  for (int k = t; k < rollout.shape.steps; ++k) {
    const End end = rollout.end(k, env);
    double next = rollout.value(k + 1, env);
    if (end == End::kTerminated) next = 0.0;
    if (end == End::kTimeout) next = rollout.timeout_value(k, env);
    sum += weight * (rollout.reward(k, env) + gamma * next - rollout.value(k, env));
    weight *= gamma * lambda;
    if (end != End::kNone) break;
  }
  return sum;
}

TEST(GaeTest, MatchesTheDefinitionAcrossTerminationsAndTimeouts) {
  const RolloutShape shape{6, 12, 1};
  Rollout rollout(shape, 1);
  for (int env = 0; env < shape.envs; ++env) {
    for (int t = 0; t <= shape.steps; ++t) {
      const auto counter = std::uint64_t{100} * env + t;
      const auto [a, b] = random_normal_pair(1, Stream::kAction, counter, 0);
      rollout.value(t, env) = a;
      if (t == shape.steps) break;
      rollout.reward(t, env) = b;
      rollout.timeout_value(t, env) = random_normal_pair(1, Stream::kAction, counter, 1).first;
    }
  }
  rollout.end(0, 1) = End::kTerminated;
  rollout.end(11, 1) = End::kTerminated;
  rollout.end(4, 2) = End::kTimeout;
  rollout.end(5, 2) = End::kTimeout;
  rollout.end(11, 3) = End::kTimeout;
  rollout.end(7, 4) = End::kTerminated;
  const double gamma = 0.97;
  const double lambda = 0.9;
  compute_gae(rollout, 0, 2, gamma, lambda);  // in two blocks
  compute_gae(rollout, 2, 4, gamma, lambda);
  for (int env = 0; env < shape.envs; ++env) {
    for (int t = 0; t < shape.steps; ++t) {
      const double expected = advantage_by_definition(rollout, t, env, gamma, lambda);
      EXPECT_NEAR(rollout.advantage(t, env), expected, 2e-6) << "t " << t << ", env " << env;
      EXPECT_NEAR(rollout.value_target(t, env), expected + rollout.value(t, env), 2e-6);
    }
  }
}

}  // namespace
}  // namespace sandrunner::learner
