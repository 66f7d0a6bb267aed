// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/learner/learner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "rt/core/processor.h"
#include "rt/core/state_hash.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"
#include "tests/tools/train/data/thread_ranks.h"
#include "toy_task.h"

namespace sandrunner::learner {
namespace {

LearnerConfig small_config() {
  LearnerConfig config;
  config.network = {12, {10}, {16, 12}, {14}};
  config.block_envs = 8;
  return config;
}
/// The policy is also pulled towards its mirror image.
LearnerConfig with_mirror() {
  LearnerConfig config = small_config();
  config.loss.symmetry_weight = 0.1;
  return config;
}
const RolloutShape kSmallShape{64, 8, kToyPrivileged};

/// A training on the toy task, whose symmetry it knows.
struct Training {
  Training(int threads, std::uint64_t seed, const LearnerConfig& config = small_config(),
           const Kernels<float>& kernels = best_kernels<float>())
      : pool(threads),
        learner(config, kSmallShape, seed, pool, toy_symmetry(), kernels),
        task(learner, pool) {}

  void run(int windows) {
    for (int i = 0; i < windows; ++i) {
      task.run_window();
      last = learner.update();
    }
  }

  WorkerPool pool;
  Learner learner;
  ToyTask task;
  UpdateStats last;
};

TEST(LearnerTest, SameSeedGivesTheSameWeightsForAnyNumberOfThreads) {
  Training one(1, 4, with_mirror());
  Training again(1, 4, with_mirror());
  Training three(3, 4, with_mirror());
  Training other_seed(1, 5, with_mirror());
  for (Training* training : {&one, &again, &three, &other_seed}) training->run(6);
  EXPECT_EQ(one.learner.parameters(), again.learner.parameters());
  EXPECT_EQ(one.learner.parameters(), three.learner.parameters());
  EXPECT_NE(one.learner.parameters(), other_seed.learner.parameters());
  EXPECT_EQ(one.learner.updates(), 6u);
  EXPECT_EQ(one.learner.transitions(), 6u * 64u * 8u);
}

TEST(LearnerTest, SameSeedGivesTheSameWeightsForAnyNumberOfRanks) {
  Training alone(1, 4, with_mirror());
  alone.run(6);
  Checkpoint expected;
  alone.learner.save(expected);
  for (const int size : {2, 3, 5}) {
    run_ranks(size, [&](const Ranks& ranks, int) {
      Training shared(2, 4, with_mirror());
      shared.learner.share_with(ranks);
      shared.run(6);
      Checkpoint checkpoint;
      shared.learner.save(checkpoint);
      checkpoint.gather(ranks, shared.learner.blocks());
      EXPECT_EQ(checkpoint.sections, expected.sections);
    });
  }
}

TEST(LearnerTest, SameSeedGivesTheSameWeightsWithAvx2AndAvx512) {
  if (!has_avx512()) GTEST_SKIP() << "this processor has no AVX-512";
  Training x8(1, 4, with_mirror(), kernels_x8());
  Training x16(2, 4, with_mirror(), kernels_x16());
  for (Training* training : {&x8, &x16}) training->run(6);
  EXPECT_EQ(x8.learner.parameters(), x16.learner.parameters());
}

TEST(LearnerTest, WeightsAreThoseWrittenDownFromBothCompilers) {
  Training training(2, 4);
  training.run(6);
  StateHash hash;
  for (const float weight : training.learner.parameters()) {
    hash.add(std::uint64_t{std::bit_cast<std::uint32_t>(weight)});
  }
  EXPECT_EQ(hash.value(), 0x62B9524325FC6244u);
}

TEST(LearnerTest, ResumesToTheWeightsOfAnUninterruptedRun) {
  const TemporaryFolder folder;
  const std::string path = folder.path("checkpoint.bin");
  Training whole(1, 4, with_mirror());
  whole.run(7);
  {
    Training first(2, 4, with_mirror());
    first.run(2);
    Checkpoint checkpoint;
    first.learner.save(checkpoint);
    checkpoint.put("task", first.task.states.data(), first.task.states.size());
    save_checkpoint(checkpoint, path);
    first.run(1);  // lost with the kill
  }
  for (const int windows : {4, 1}) {
    Training next(1, 77, with_mirror());  // the seed, too, comes from the checkpoint
    const Checkpoint loaded = load_checkpoint(path);
    next.learner.load(loaded);
    loaded.get("task", next.task.states.data(), next.task.states.size());
    next.run(windows);
    Checkpoint checkpoint;
    next.learner.save(checkpoint);
    checkpoint.put("task", next.task.states.data(), next.task.states.size());
    save_checkpoint(checkpoint, path);
  }
  Checkpoint expected;
  whole.learner.save(expected);
  expected.put("task", whole.task.states.data(), whole.task.states.size());
  EXPECT_EQ(load_checkpoint(path).sections, expected.sections);
}

TEST(LearnerTest, SymmetryWeightPullsTheAnswersToBothImagesTogether) {
  const auto asymmetry = [](double weight) {
    LearnerConfig config = small_config();
    config.loss.symmetry_weight = weight;
    Training training(1, 4, config);
    training.run(30);
    return training.last.asymmetry;
  };
  // 0.04 and 0.85 standard deviations of the action.
  EXPECT_LT(asymmetry(1.0), 0.5 * asymmetry(1e-9));
  EXPECT_TRUE(std::isnan(asymmetry(0.0)));
}

TEST(LearnerTest, AnswersArePulledByWhatHasLongDifferedInTheMirror) {
  LearnerConfig config = with_mirror();
  Training now(1, 4, config);
  config.symmetry_steps = 10;
  Training lately(1, 4, config);
  for (Training* training : {&now, &lately}) training->task.run_window();
  const Rollout& rollout = lately.learner.rollout();
  Matrix<float> expected = Matrix<float>::Zero(kActionSize, kSmallShape.envs);
  int resets = 0;
  for (int t = 0; t < kSmallShape.steps; ++t) {
    const Matrix<float> differs =
        now.learner.rollout().mean(t) - now.learner.rollout().symmetric_mean(t);
    for (int env = 0; env < kSmallShape.envs; ++env) {
      if (rollout.reset(t, env) != 0) {
        expected.col(env).setZero();
        resets += t > 0 ? 1 : 0;
      }
      expected.col(env) += 0.1f * (differs.col(env) - expected.col(env));
    }
    const Matrix<float> pulled_by = rollout.mean(t) - rollout.symmetric_mean(t);
    EXPECT_LT((pulled_by - expected).cwiseAbs().maxCoeff(), 1e-6f);
    EXPECT_GT(differs.cwiseAbs().maxCoeff(), 1e-3f);
  }
  EXPECT_GT(resets, 0);
}

TEST(LearnerTest, AveragedWeightsAreTheRunningMeanOfTheUpdates) {
  LearnerConfig config = small_config();
  config.average_updates = 3;
  Training training(1, 4, config);
  std::vector<float> mean = training.learner.parameters();
  for (int update = 1; update <= 5; ++update) {
    training.run(1);
    const std::vector<float>& now = training.learner.parameters();
    for (std::size_t i = 0; i < mean.size(); ++i) {
      mean[i] += 1.0f / static_cast<float>(std::min(update, 3)) * (now[i] - mean[i]);
    }
  }
  for (std::size_t i = 0; i < mean.size(); ++i) {
    ASSERT_NEAR(training.learner.averaged()[i], mean[i], 1e-6f) << i;
  }
}

TEST(LearnerTest, RefusesACheckpointOfAnotherArchitecture) {
  Training training(1, 1);
  Checkpoint checkpoint;
  training.learner.save(checkpoint);
  checkpoint.source = "a.bin";
  LearnerConfig config = small_config();
  config.network.actor = {16, 16};
  Training other(1, 1, config);
  const std::vector<float> before = other.learner.parameters();
  EXPECT_EQ(error_of([&] { other.learner.load(checkpoint); }),
            "a.bin: checkpoint is for envs 64 of 8, privileged 3, hidden 12, estimator 10, actor "
            "16-12, critic 14; expected envs 64 of 8, privileged 3, hidden 12, estimator 10, "
            "actor 16-16, critic 14");
  EXPECT_EQ(other.learner.parameters(), before);
}

TEST(LearnerTest, LeavesParametersWhenALossIsNotFinite) {
  Training training(2, 1);
  training.run(2);
  for (const float bad : {std::nanf(""), std::numeric_limits<float>::infinity(),
                          1e30f /* its square is not finite */}) {
    Checkpoint before;
    training.learner.save(before);
    training.task.run_window();
    training.learner.rollout().reward(3, 40) = bad;
    const UpdateStats stats = training.learner.update();
    EXPECT_FALSE(stats.finite) << bad;
    Checkpoint after;
    training.learner.save(after);
    for (const char* section : {"learner.parameters", "learner.adam_m", "learner.adam_v"}) {
      EXPECT_EQ(after.sections.at(section), before.sections.at(section)) << section;
    }
  }
  training.run(1);
  EXPECT_TRUE(training.last.finite);
}

TEST(LearnerTest, FirstMinibatchMeetsThePolicyThatActed) {
  LearnerConfig config = small_config();
  config.epochs = 1;
  config.minibatches = 1;
  Training training(1, 2, config);
  training.run(3);  // memories carried over from earlier windows, and resets
  EXPECT_LT(std::abs(training.last.kl), 1e-10);
}

TEST(LearnerTest, SampledActionsHaveTheStatedMeanAndDeviation) {
  Training training(1, 3);
  double sum = 0.0;
  double square = 0.0;
  double log_prob_error = 0.0;
  int count = 0;
  const Rollout& rollout = training.learner.rollout();
  const double expected_norm =
      kActionSize * (std::log(0.6) + 0.5 * std::log(2.0 * std::numbers::pi));
  training.task.run_window();
  for (int t = 0; t < kSmallShape.steps; ++t) {
    for (int env = 0; env < kSmallShape.envs; ++env) {
      double squares = 0.0;
      for (int k = 0; k < kActionSize; ++k) {
        const double z = (rollout.action(t)(k, env) - rollout.mean(t)(k, env)) / 0.6;
        sum += z;
        squares += z * z;
        ++count;
      }
      square += squares;
      log_prob_error = std::max(
          log_prob_error,
          std::abs(static_cast<double>(rollout.log_prob(t, env)) + 0.5 * squares + expected_norm));
    }
  }
  EXPECT_NEAR(sum / count, 0.0, 5.0 / std::sqrt(count));
  EXPECT_NEAR(square / count, 1.0, 5.0 * std::sqrt(2.0 / count));
  EXPECT_LT(log_prob_error, 1e-4);

  const float first_noise = rollout.action(0)(0, 0) - rollout.mean(0)(0, 0);
  training.learner.update();
  training.task.run_window();
  const float next_noise = rollout.action(0)(0, 0) - rollout.mean(0)(0, 0);
  EXPECT_GT(std::abs(next_noise - first_noise), 0.05f);  // not the same noise in every window
}

TEST(LearnerTest, LearningRateFollowsTheDivergence) {
  const LearnerConfig config;  // target 0.02
  EXPECT_DOUBLE_EQ(adapted_learning_rate(1e-3, 0.009, config), 1.2e-3);
  EXPECT_DOUBLE_EQ(adapted_learning_rate(1e-3, 0.011, config), 1e-3);
  EXPECT_DOUBLE_EQ(adapted_learning_rate(1e-3, 0.039, config), 1e-3);
  EXPECT_DOUBLE_EQ(adapted_learning_rate(1e-3, 0.041, config), 1e-3 / 1.3);
  EXPECT_DOUBLE_EQ(adapted_learning_rate(1.9e-3, 0.0, config), 2e-3);
  EXPECT_DOUBLE_EQ(adapted_learning_rate(2.1e-5, 1.0, config), 2e-5);
}

TEST(LearnerTest, DeviationStopsAtItsFloor) {
  LearnerConfig config = small_config();
  config.loss.entropy_weight = -1.0;  // rewards a narrow policy
  config.action_std_start = 0.21;
  config.kl_target = 10.0;
  Training training(1, 1, config);
  training.run(10);
  EXPECT_NEAR(training.last.action_std, 0.2, 1e-6);
}

TEST(LearnerTest, NamesTheSettingThatDoesNotFitTheOthers) {
  WorkerPool pool(1);
  const auto message = [&](const LearnerConfig& config, const RolloutShape& shape) {
    return error_of([&] { const Learner learner(config, shape, 1, pool); });
  };
  LearnerConfig config = small_config();
  EXPECT_EQ(message(config, kSmallShape), "");
  EXPECT_EQ(message(config, {60, 8, kToyPrivileged}),
            "learner: envs is 60, expected a multiple of block_envs, 8");
  EXPECT_EQ(message(config, {16, 8, kToyPrivileged}),
            "learner: envs is 16, expected at least a block of 8 for each of 4 minibatches");
  config.action_std_min = 0.7;
  EXPECT_EQ(message(config, kSmallShape),
            "learner: action_std_start is 0.6, expected at least action_std_min");
  config = small_config();
  config.learning_rate_max = 1e-5;
  EXPECT_EQ(message(config, kSmallShape),
            "learner: learning_rate_start is 0.0005, expected between learning_rate_min and "
            "learning_rate_max");
}

}  // namespace
}  // namespace sandrunner::learner
