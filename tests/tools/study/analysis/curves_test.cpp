// SPDX-License-Identifier: BSD-3-Clause
// The fit of the cost of transport, the embedding and its neighbours, on data with known answers.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/lanes/random.h"
#include "tests/support/not_finite.h"
#include "tools/study/analysis/curve_fit.h"
#include "tools/study/analysis/neighbours.h"

namespace sandrunner::study {
namespace {

TEST(CotCurveTest, FindsTheCurveOfItsOwnPoints) {
  const CotCurve truth{0.8, -1.3, 0.05, 0.4};
  std::vector<double> x, y;
  for (double v = 0.4; v < 4.0; v += 0.2) {
    x.push_back(v);
    y.push_back(truth.at(v));
  }
  y[3] = kNan;
  const auto found = fit_cot_curve(x, y);
  ASSERT_TRUE(found.has_value());
  for (double v = 0.4; v < 4.0; v += 0.1) EXPECT_NEAR(found->at(v), truth.at(v), 1e-3) << v;
}

TEST(CotCurveTest, RefusesFewerThanFivePoints) {
  EXPECT_FALSE(fit_cot_curve({1, 2, 3, 4}, {1, 2, 3, 4}).has_value());
  EXPECT_FALSE(fit_cot_curve({1, 2, 3, 4, 5}, {1, 2, kNan, 4, 5}).has_value());
  EXPECT_TRUE(fit_cot_curve({1, 2, 3, 4, 5}, {1, 2, 3, 4, 5}).has_value());
}

// Three clusters far apart in five dimensions, each of two runs on a ground of its own; the phase
// goes round along the first dimension.
States clusters(int of_each = 30) {
  States states;
  states.points = Points(3 * of_each, 5);
  for (int i = 0; i < 3 * of_each; ++i) {
    const int cluster = i % 3, run = 2 * cluster + (i / 3) % 2;
    for (int k = 0; k < 5; ++k) {
      const double noise = sim::random_normal(
          1, 2, 5 * static_cast<std::uint64_t>(i) + static_cast<std::uint64_t>(k));
      states.points(i, k) = 8.0 * (k == cluster) + 0.3 * noise;
    }
    const double phase = sim::random_uniform(1, 3, static_cast<std::uint64_t>(i));
    states.points(i, 3) = 2.0 * std::cos(2.0 * M_PI * phase);
    states.points(i, 4) = 2.0 * std::sin(2.0 * M_PI * phase);
    states.run.push_back(run);
    states.phase.push_back(phase);
  }
  states.ground = {0, 0, 1, 1, 2, 2};
  return states;
}

TEST(TsneTest, GradientIsThatOfTheDivergence) {
  const Eigen::ArrayXXd joint = joint_probabilities(clusters(6).points, 5.0);
  Points y(18, 2);
  for (int i = 0; i < 36; ++i) y(i % 18, i / 18) = sim::random_normal(1, 4, std::uint64_t(i));
  const Points gradient = tsne_gradient(joint, y, 1.0);
  constexpr double kStep = 1e-5;
  for (const auto& [row, column] : {std::pair{0, 0}, {7, 1}, {17, 0}}) {
    Points up = y, down = y;
    up(row, column) += kStep;
    down(row, column) -= kStep;
    const double expected =
        (tsne_divergence(joint, up) - tsne_divergence(joint, down)) / (2.0 * kStep);
    EXPECT_NEAR(gradient(row, column), expected, 1e-7);
  }
}

TEST(TsneTest, JointProbabilitiesAreSymmetricAndSumToOne) {
  const Eigen::ArrayXXd joint = joint_probabilities(clusters().points, 10.0);
  EXPECT_NEAR(joint.sum(), 1.0, 1e-9);
  EXPECT_TRUE(joint.isApprox(joint.transpose()));
  EXPECT_EQ(joint(3, 3), 0.0);
}

TEST(TsneTest, ThreeClustersStayApart) {
  const States states = clusters();
  const Points y = tsne(states.points, {.perplexity = 10.0});
  for (int i = 0; i < y.rows(); ++i) {
    // The nearest point in the picture is of the same cluster.
    double least = 1e300;
    int nearest = -1;
    for (int j = 0; j < y.rows(); ++j) {
      const double d = (y.row(i) - y.row(j)).square().sum();
      if (j != i && d < least) {
        least = d;
        nearest = j;
      }
    }
    EXPECT_EQ(nearest % 3, i % 3) << i;
  }
}

TEST(NeighboursTest, AreOfOtherRuns) {
  const States states = clusters();
  const auto neighbours = neighbours_in_other_runs(states, 4);
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    ASSERT_EQ(neighbours[i].size(), 4u);
    for (const int j : neighbours[i]) EXPECT_NE(states.run[j], states.run[i]);
  }
}

TEST(NeighboursTest, TellTheGroundsOfClustersAndNothingOfShuffledLabels) {
  const States states = clusters();
  const auto neighbours = neighbours_in_other_runs(states, 5);
  EXPECT_EQ(share_told(states, neighbours, states.ground), 1.0);
  EXPECT_GT(phase_told(states, neighbours), 0.9);
  // Runs whose states lie among those of another ground tell that one.
  EXPECT_EQ(share_told(states, neighbours, {0, 1, 1, 2, 2, 0}), 0.0);
}

TEST(NeighboursTest, OfStatesWithoutOrderTellNothing) {
  States states = clusters();
  for (int i = 0; i < states.points.size(); ++i) {
    states.points(i % states.points.rows(), i / states.points.rows()) =
        sim::random_normal(5, 6, std::uint64_t(i));
  }
  const auto neighbours = neighbours_in_other_runs(states, 10);
  EXPECT_LE(share_told(states, neighbours, states.ground),
            shuffled_share_told(states, neighbours) + 0.1);
  EXPECT_LT(phase_told(states, neighbours), 0.4);
}

}  // namespace
}  // namespace sandrunner::study
