// SPDX-License-Identifier: BSD-3-Clause
// The backward passes against central differences of the forward pass, in double.
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "random_rollout.h"
#include "tools/train/learner/block_pass.h"

namespace sandrunner::learner {
namespace {

// Block: the last 3 of 5 environments; heads in chunks of 2, 2, 1 steps.
constexpr int kEnvs = 3;
constexpr int kFirstEnv = 2;
constexpr int kChunkSteps = 2;
const RolloutShape kShape{5, 5, 9};
constexpr int kSamples = kEnvs * 5;
const LossConfig kLoss{0.2, 0.7, 1.3, 0.01, 0.3, 0.8, 0.6, 0.4};
const AdvantageScale kScale{0.1, 1.4};

NetworkSizes sizes() { return {5, {7, 6}, {8, 7}, {6, 5}}; }

RolloutShape shape_for(const NetworkSizes& sizes) {
  RolloutShape shape = kShape;
  shape.insight = sizes.wiring.sees_insight() ? kInsightSize : 0;
  shape.teacher = sizes.hidden;
  return shape;
}

/// Networks, a rollout, and the loss of it.
class Gradients {
 protected:
  explicit Gradients(const NetworkSizes& sizes)
      : layout_(sizes, kShape.privileged),
        rollout_(random_rollout<double>(shape_for(sizes), layout_.memory())),
        pass_(layout_, kShape.steps, kEnvs, kChunkSteps),
        weights_(layout_),
        parameters_(random_parameters(layout_)) {}

  /// The parameters as they are now.
  const Weights<double>& weights() {
    weights_.set(parameters_.data());
    return weights_;
  }

  double loss(const LossConfig& config, LossSums* sums_out = nullptr) {
    std::vector<double> unused(parameters_.size());
    const LossSums sums = pass_.loss_and_gradient(weights(), rollout_, kFirstEnv, config, kScale,
                                                  kSamples, unused.data());
    if (sums_out != nullptr) *sums_out = sums;
    double estimate = 0.0;
    for (const double square : sums.estimate_square) estimate += square / kEstimateSize;
    return (config.policy_weight * sums.policy + config.value_weight * sums.value +
            config.estimate_weight * estimate + config.symmetry_weight * sums.asymmetry +
            config.imitation_weight * sums.imitation + config.encoding_weight * sums.encoding) /
               kSamples -
           config.entropy_weight * entropy(parameters_.data() + layout_.log_std());
  }

  std::vector<double> gradient(const LossConfig& config) {
    std::vector<double> result(parameters_.size());
    pass_.loss_and_gradient(weights(), rollout_, kFirstEnv, config, kScale, kSamples,
                            result.data());
    return result;
  }

  /// Compares every tensor but those whose names begin with `skipped`.
  void expect_gradient_matches_differences(const LossConfig& config,
                                           const std::string& skipped = "none") {
    const std::vector<double> analytic = gradient(config);
    for (const TensorView& tensor : layout_.tensors()) {
      if (tensor.name.starts_with(skipped)) continue;
      double error_square = 0.0;
      double norm_square = 0.0;
      for (int i = 0; i < tensor.rows * tensor.cols; ++i) {
        const auto index = static_cast<std::size_t>(tensor.offset + i);
        const double step = 1e-5;
        const double value = parameters_[index];
        parameters_[index] = value + step;
        const double above = loss(config);
        parameters_[index] = value - step;
        const double below = loss(config);
        parameters_[index] = value;
        const double difference = (above - below) / (2.0 * step);
        error_square += std::pow(difference - analytic[index], 2);
        norm_square += std::pow(difference, 2);
      }
      EXPECT_GT(norm_square, 1e-10) << tensor.name << " has no influence: nothing was checked";
      EXPECT_LE(std::sqrt(error_square / norm_square), 1e-6) << tensor.name;
    }
  }

  /// Sets columns [first, first + count) of a tensor to zero.
  void clear_columns(const std::string& name, int first, int count) {
    for (const TensorView& tensor : layout_.tensors()) {
      if (tensor.name != name) continue;
      for (int row = 0; row < tensor.rows; ++row) {
        for (int col = first; col < first + count; ++col) {
          parameters_[static_cast<std::size_t>(tensor.offset + row * tensor.cols + col)] = 0.0;
        }
      }
    }
  }

  ParameterLayout layout_;
  BasicRollout<double> rollout_;
  BlockPass<double> pass_;
  Weights<double> weights_;
  std::vector<double> parameters_;
};

class GradientTest : public testing::Test, protected Gradients {
 protected:
  GradientTest() : Gradients(sizes()) {}
};

struct WiredCase {
  const char* name;
  EncoderKind encoder;
  ActorInputs actor;
};

NetworkSizes wired(const WiredCase& wiring) {
  NetworkSizes networks = sizes();
  networks.wiring.encoder = wiring.encoder;
  networks.wiring.actor_sees = wiring.actor;
  networks.insight = {6};
  networks.channels = 4;
  return networks;
}

class WiringGradientTest : public testing::TestWithParam<WiredCase>, protected Gradients {
 protected:
  WiringGradientTest() : Gradients(wired(GetParam())) {}
};

INSTANTIATE_TEST_SUITE_P(
    Study, WiringGradientTest,
    testing::Values(WiredCase{"robot", EncoderKind::kLstm, {true, true, false, false}},
                    WiredCase{"tcn", EncoderKind::kTcn, {true, true, false, false}},
                    WiredCase{"oracle_h", EncoderKind::kLstm, {true, true, false, true}},
                    WiredCase{"oracle_o", EncoderKind::kLstm, {false, true, true, true}},
                    WiredCase{"teacher", EncoderKind::kInsight, {true, false, true, false}},
                    WiredCase{"student", EncoderKind::kLstm, {true, false, true, false}}),
    [](const auto& param) { return std::string(param.param.name); });

TEST_P(WiringGradientTest, EveryTensorMatchesDifferencesWithResetsInsideTheWindow) {
  // The actor's gradient stops at the estimate, which differences cannot know: take its influence
  // away.
  if (GetParam().actor.estimate) {
    clear_columns("actor.0.weight",
                  kCommandSize + (GetParam().actor.encoding ? layout_.hidden() : 0), kEstimateSize);
  }
  LossSums sums;
  loss(kLoss, &sums);
  ASSERT_GT(sums.clipped, 0.0);  // both branches of the clipped objective
  ASSERT_LT(sums.clipped, kSamples);
  std::set<int> reset_steps;
  for (int t = 0; t < kShape.steps; ++t) {
    for (int env = kFirstEnv; env < kFirstEnv + kEnvs; ++env) {
      if (rollout_.reset(t, env) != 0) reset_steps.insert(t);
    }
  }
  ASSERT_GE(reset_steps.size(), 2u);
  ASSERT_GT(*reset_steps.rbegin(), 0);
  expect_gradient_matches_differences(kLoss);
}

TEST_F(GradientTest, EncoderAndActorMatchDifferencesWhenTheActorSeesTheEstimate) {
  // With the estimator's last layer zero its estimate does not depend on h, but its bias still
  // enters the actor.
  clear_columns("estimator.2.weight", 0, sizes().estimator.back());
  expect_gradient_matches_differences(kLoss, "estimator");
}

TEST_F(GradientTest, ActorDoesNotTrainTheEstimator) {
  LossConfig config = kLoss;
  config.estimate_weight = 0.0;
  const std::vector<double> result = gradient(config);
  for (const TensorView& tensor : layout_.tensors()) {
    double norm = 0.0;
    for (int i = 0; i < tensor.rows * tensor.cols; ++i) {
      norm += std::abs(result[static_cast<std::size_t>(tensor.offset + i)]);
    }
    if (tensor.name.starts_with("estimator")) {
      EXPECT_EQ(norm, 0.0) << tensor.name;
    } else {
      EXPECT_GT(norm, 0.0) << tensor.name;
    }
  }
}

TEST_F(GradientTest, FloatMatchesDouble) {
  const std::vector<double> expected = gradient(kLoss);
  const std::vector<float> parameters(parameters_.begin(), parameters_.end());
  std::vector<float> actual(parameters.size());
  BlockPass<float> pass(layout_, kShape.steps, kEnvs, kChunkSteps);
  Weights<float> weights(layout_);
  weights.set(parameters.data());
  pass.loss_and_gradient(weights,
                         random_rollout<float>(shape_for(layout_.sizes()), layout_.memory()),
                         kFirstEnv, kLoss, kScale, kSamples, actual.data());
  for (const TensorView& tensor : layout_.tensors()) {
    double error_square = 0.0;
    double norm_square = 0.0;
    for (int i = 0; i < tensor.rows * tensor.cols; ++i) {
      const auto index = static_cast<std::size_t>(tensor.offset + i);
      error_square += std::pow(static_cast<double>(actual[index]) - expected[index], 2);
      norm_square += std::pow(expected[index], 2);
    }
    EXPECT_LE(std::sqrt(error_square / norm_square), 2e-5) << tensor.name;
  }
}

TEST_F(GradientTest, KlIsThatOfDiagonalGaussians) {
  // With the last layer's weights zero the mean is its bias.
  clear_columns("actor.2.weight", 0, sizes().actor.back());
  const double* bias = parameters_.data() + layout_.actor().back().bias;
  const double* log_std = parameters_.data() + layout_.log_std();
  double expected = 0.0;
  for (int t = 0; t < kShape.steps; ++t) {
    for (int env = kFirstEnv; env < kFirstEnv + kEnvs; ++env) {
      for (int k = 0; k < kActionSize; ++k) {
        const double old_std = std::exp(rollout_.log_std(k));
        const double new_std = std::exp(log_std[k]);
        const double shift = rollout_.mean(t)(k, env) - bias[k];
        expected += std::log(new_std / old_std) +
                    (old_std * old_std + shift * shift) / (2.0 * new_std * new_std) - 0.5;
      }
    }
  }
  LossSums sums;
  loss(kLoss, &sums);
  EXPECT_NEAR(sums.kl, expected, 1e-10 * expected);
}

}  // namespace
}  // namespace sandrunner::learner
