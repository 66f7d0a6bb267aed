// SPDX-License-Identifier: BSD-3-Clause
// What networks of a study are shown besides what sensors measure.
#include <gtest/gtest.h>

#include "sim/ground/terrain_description.h"
#include "tools/train/task/robot_settings.h"
#include "tools/train/task/task.h"

namespace sandrunner::train {
namespace {

// Rows of the critic's input: observation, estimate, 4 of each foot of which the first is its load,
// the last action, the ground.
constexpr int kFeetRow = kObservationSize + kEstimateSize;
constexpr int kGroundRow = kFeetRow + 4 * kNumLegs + kNumJoints;
constexpr int kInsightEnvs = 64;

TEST(InsightTest, IsTheGroundAndTheTruthThatTheCriticSees) {
  const sim::Robot robot = sim::load_raibo();
  Task task(shipped_task_config(robot), robot, {kInsightEnvs, kInsightEnvs}, 3);
  learner::Rollout rollout({kInsightEnvs, 2, Task::privileged_size(), kInsightSize}, 0);
  task.observe(0, 0, rollout);
  for (int t = 0; t < 2; ++t) task.step(0, t, rollout);
  const auto insight = rollout.insight(2);
  EXPECT_EQ(insight.topRows(6), rollout.privileged(2).middleRows(kGroundRow, 6));
  EXPECT_EQ(insight.middleRows(kTerrainSize, kEstimateSize), rollout.estimate_target(2));
  for (int leg = 0; leg < kNumLegs; ++leg) {
    EXPECT_EQ(insight.row(kTerrainSize + kEstimateSize + leg),
              rollout.privileged(2).row(kFeetRow + 4 * leg));
  }
  // Soil has all ten parameters, hard ground the first six.
  int soils = 0;
  for (int env = 0; env < kInsightEnvs; ++env) {
    const bool hard = insight(0, env) == 1.0f;
    soils += hard ? 0 : 1;
    EXPECT_EQ((insight.col(env).segment(6, 4).array() == 0.0f).all(), hard);
  }
  EXPECT_GT(soils, 0);
  EXPECT_LT(soils, kInsightEnvs);
}

TEST(InsightTest, ATrialShowsTheGroundThatItGives) {
  const sim::Robot robot = sim::load_raibo();
  Task task(shipped_task_config(robot), robot, {kInsightEnvs, kInsightEnvs}, 3);
  sim::GroundParameters ground;
  ground.sigma_flat_npm3 = 30e6;
  ground.recruitment = 2.3;
  sim::Terrain<double> terrain;
  const auto foot = sim::make_foot_profile({}, robot.model);
  terrain.ground[0] = sim::derive_ground(ground, foot, robot.model.foot_radius_m);
  const auto one_patch = sim::convert_terrain<float>(terrain);
  Trial trial;
  trial.terrain = &one_patch;
  trial.features = terrain_features(ground, 1.0);
  task.begin_trial(0, trial);
  learner::Rollout rollout({kInsightEnvs, 1, Task::privileged_size(), kInsightSize}, 0);
  task.observe(0, 0, rollout);
  EXPECT_FLOAT_EQ(rollout.insight(0)(1, 0), 1.0f);
  EXPECT_FLOAT_EQ(rollout.insight(0)(6, 0), 1.0f);
}

// Left and right exchanged: in the mirror the body moves to the other side and the legs change
// places.
TEST(InsightTest, ReflectionTurnsSidewaysVelocityAndExchangesLegs) {
  const learner::Reflection reflection = Task::symmetry(sim::load_raibo()).insight;
  Eigen::Matrix<float, kInsightSize, 1> insight;
  for (int i = 0; i < kInsightSize; ++i) insight(i) = static_cast<float>(i + 1);
  std::array<float, kInsightSize> scratch;
  Eigen::Matrix<float, kInsightSize, 1> image = insight;
  reflection.apply(image, scratch.data());
  EXPECT_EQ(image.head(kTerrainSize), insight.head(kTerrainSize));
  const std::array<float, 12> rest{11, 12, -13, 14, 16, 15, 18, 17, 20, 19, 22, 21};
  for (int i = 0; i < 12; ++i) EXPECT_EQ(image(kTerrainSize + i), rest[i]);
}

}  // namespace
}  // namespace sandrunner::train
