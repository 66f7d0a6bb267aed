// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/experiments/attribution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace sandrunner::study {
namespace {

using learner::Matrix;
using learner::Vector;

/// Layers of these widths and their weights: [W | b] of one after the other.
struct Net {
  std::vector<learner::LayerView> layers;
  std::vector<float> parameters;

  explicit Net(const std::vector<int>& widths) {
    std::mt19937 random(1);  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same each time
    std::normal_distribution<float> normal;
    std::ptrdiff_t at = 0;
    for (std::size_t i = 0; i + 1 < widths.size(); ++i) {
      const int in = widths[i], out = widths[i + 1];
      layers.push_back({in, out, at, at + std::ptrdiff_t{in} * out});
      at += std::ptrdiff_t{in} * out + out;
      while (static_cast<std::ptrdiff_t>(parameters.size()) < at) {
        parameters.push_back(normal(random) / std::sqrt(static_cast<float>(in)));
      }
    }
  }
  float& weight(int layer, int output, int input) {
    const learner::LayerView& view = layers[static_cast<std::size_t>(layer)];
    return parameters[static_cast<std::size_t>(view.weight + output * view.inputs + input)];
  }
  ActorFunction function() const { return {layers, parameters}; }
};

Matrix<float> random_states(int inputs, int count) {
  std::mt19937 random(2);  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same each time
  std::normal_distribution<float> normal(0.3f, 1.0f);
  return Matrix<float>::NullaryExpr(inputs, count, [&] { return normal(random); });
}

TEST(IntegratedGradientsTest, OfALinearNetworkAreWeightTimesWay) {
  Net net({3, 2});
  ActorFunction f = net.function();
  const Vector<float> x{{1.0f, -2.0f, 0.5f}}, reference{{0.25f, 1.0f, 0.5f}};
  const Matrix<float> found = f.integrated_gradients(x, reference);
  for (int k = 0; k < 2; ++k) {
    for (int i = 0; i < 3; ++i) EXPECT_EQ(found(k, i), net.weight(0, k, i) * (x[i] - reference[i]));
  }
}

TEST(IntegratedGradientsTest, CountAKinkByTheShareOfTheWayBehindIt) {
  Net net({1, 1, 1});
  net.parameters = {1.0f, 0.0f, 3.0f, 0.5f};  // 3 leaky(x) + 0.5
  ActorFunction f = net.function();
  // From -1 to 3 a quarter of the way has the small slope.
  const Matrix<float> found = f.integrated_gradients(Vector<float>{{3.0f}}, Vector<float>{{-1.0f}});
  EXPECT_NEAR(found(0, 0), 4.0f * 3.0f * (0.75f + 0.25f * learner::kLeakySlope<float>), 1e-5f);
}

TEST(IntegratedGradientsTest, AddUpToTheChangeOfTheAnswer) {
  const Net net({51, 256, 128, 12});
  const Matrix<float> states = random_states(51, 40);
  WorkerPool pool(1);
  const Attribution a = attribute(net.function(), states, {}, pool);
  EXPECT_LT(*std::ranges::max_element(a.gap), 0.05);
  std::vector<double> gaps = a.gap;
  std::ranges::sort(gaps);
  EXPECT_LT(gaps[gaps.size() / 2], 0.01);
}

TEST(AblationTest, OfInputsThatAreIgnoredIsZero) {
  Net net({6, 8, 3});
  for (int k = 0; k < 8; ++k) net.weight(0, k, 2) = net.weight(0, k, 3) = 0.0f;
  WorkerPool pool(1);
  const Attribution a =
      attribute(net.function(), random_states(6, 100),
                {{"ignored", 2, 2}, {"first", 0, 2}, {"one of both", 3, 2}}, pool);
  EXPECT_EQ(a.ablation.row(0).maxCoeff(), 0.0);
  EXPECT_GT(a.ablation.row(1).minCoeff(), 0.0);
  EXPECT_GT(a.ablation.row(2).minCoeff(), 0.0);
  EXPECT_EQ(a.gradients.col(2).maxCoeff(), 0.0);
  EXPECT_GT(a.gradients.col(1).minCoeff(), 0.0);
}

TEST(AblationTest, IsTheMeanMagnitudeOverTheOutputs) {
  Net net({2, 2});
  net.weight(0, 0, 1) = 3.0f;
  net.weight(0, 1, 1) = -1.0f;
  Matrix<float> states(2, 2);
  states << 0.5f, 0.5f,  //
      1.0f, 5.0f;
  WorkerPool pool(1);
  const Attribution a = attribute(net.function(), states, {{"second", 1, 1}}, pool);
  EXPECT_EQ(a.reference[1], 3.0f);
  EXPECT_EQ(a.deviation[0], 0.0);
  EXPECT_EQ(a.deviation[1], 2.0);
  EXPECT_NEAR(a.ablation(0, 0), 0.5 * (3.0 + 1.0) * 2.0, 1e-5);
  EXPECT_NEAR(a.gradients(0, 1), 6.0, 1e-5);
}

TEST(AttributionTest, IsTheSameForAnyNumberOfThreads) {
  const Net net({10, 16, 16, 4});
  const Matrix<float> states = random_states(10, 300);
  const std::vector<InputGroup> groups = {{"a", 0, 3}, {"b", 3, 7}};
  WorkerPool one(1), three(3);
  const Attribution a = attribute(net.function(), states, groups, one);
  const Attribution b = attribute(net.function(), states, groups, three);
  EXPECT_EQ(a.ablation, b.ablation);
  EXPECT_EQ(a.gradients, b.gradients);
  EXPECT_EQ(a.gap, b.gap);
}

}  // namespace
}  // namespace sandrunner::study
