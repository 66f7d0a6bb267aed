// SPDX-License-Identifier: BSD-3-Clause
// Slopes, layers and mud in the environments: none unless they are asked for.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rt/core/processor.h"
#include "tools/train/task/robot_settings.h"
#include "tools/train/task/task.h"

namespace sandrunner::train {
namespace {

constexpr int kBeyond = 64, kStandingSteps = 30;
constexpr double kOneDegree_rad = std::numbers::pi / 180.0;

TaskConfig undisturbed() {
  flush_denormals_to_zero();
  TaskConfig config = shipped_task_config(sim::load_raibo());
  config.episode.reset_nominal_share = 1.0;
  config.episode.push_probability = 0.0;
  return config;
}

/// A task at the end of its curriculum.
Task opened(const TaskConfig& config) {
  Task task(config, sim::load_raibo(), {kBeyond, kBeyond}, 1);
  task.set_curriculum({.speed_mps = 1.0, .ground = 1.0}, 0.0, 0.0);
  task.restart(1);
  return task;
}

double slope_rad(const sim::Shape<float>& shape) {
  return std::atan(std::hypot(double(shape.slope_x), double(shape.slope_y)));
}

TEST(BeyondSandTest, RobotsStandOnSlopesEveryWayAndDoNotFall) {
  TaskConfig config = undisturbed();
  config.ground.slope_share = 1.0;
  config.ground.sigma_flat_low = 10e6;
  config.ground.friction_low = 1.0;
  Task task = opened(config);
  learner::Rollout rollout{{kBeyond, kStandingSteps, Task::privileged_size()}, 1};
  task.observe(0, 0, rollout);
  double steepest = 0.0;
  int up = 0, left = 0;
  for (int env = 0; env < kBeyond; ++env) {
    const sim::Shape<float>& shape = task.terrain(env).shape;
    steepest = std::max(steepest, slope_rad(shape));
    up += shape.slope_x > 0.0f;
    left += shape.slope_y > 0.0f;
    EXPECT_GE(task.terrain(env).ground[0].friction, std::tan(slope_rad(shape)) + 0.299);
  }
  EXPECT_LE(steepest, 20.001 * kOneDegree_rad);
  EXPECT_GT(steepest, 18.0 * kOneDegree_rad);
  for (const int half : {up, left}) {
    EXPECT_GT(half, kBeyond / 4);
    EXPECT_LT(half, 3 * kBeyond / 4);
  }
  // By then a policy would have to act: under zero actions the legs give way.
  for (int t = 0; t < kStandingSteps; ++t) {
    rollout.action(t).setZero();
    task.step(0, t, rollout);
    for (int env = 0; env < kBeyond; ++env) {
      ASSERT_NE(rollout.end(t, env), learner::End::kTerminated) << "step " << t;
    }
  }
  for (int env = 0; env < kBeyond; ++env) {
    const sim::Mat3<float> r = sim::rotation_matrix(task.batch().state(env).rigid.orientation);
    const sim::Vec3<float> normal = task.terrain(env).shape.plane_axes().n;
    EXPECT_GT(dot(normal, {r.r0.z, r.r1.z, r.r2.z}), std::cos(12.0 * kOneDegree_rad));
  }
}

TEST(BeyondSandTest, SoilsLieOnFirmerGroundAndMudIsAmongThem) {
  TaskConfig config = undisturbed();
  config.ground.rigid_envs = config.ground.patchy_envs = 0;
  config.ground.layer_share = 0.5;
  config.ground.mud_share = 0.5;
  const Task task = opened(config);
  int mud = 0, layered = 0;
  for (int env = 0; env < kBeyond; ++env) {
    const sim::Ground<float>& ground = task.terrain(env).ground[0];
    if (ground.kind == static_cast<float>(sim::GroundKind::kMud)) {
      ++mud;
      EXPECT_GE(ground.strength, 5999.0f);
      EXPECT_LE(ground.strength, 20001.0f);
      EXPECT_LE(ground.suction, 0.7f);
    } else if (ground.layer_depth > 0.0f) {
      ++layered;
      EXPECT_GE(ground.layer_depth, 0.0199f);
      EXPECT_LE(ground.layer_depth, 0.2001f);
      EXPECT_LE(ground.layer_log_strength, std::log(25.01f));
    }
  }
  EXPECT_GT(mud, kBeyond / 4);
  EXPECT_LT(mud, 3 * kBeyond / 4);
  EXPECT_GT(layered, kBeyond / 8);
}

TEST(BeyondSandTest, AFirmerLayerIsAmongTheFeaturesTheMoreTheNearerItIs) {
  sim::GroundParameters deep, shallow;
  deep.layer_depth_m = 0.2;
  shallow.layer_depth_m = 0.05;
  constexpr std::size_t kLayer = 5;
  EXPECT_EQ(terrain_features({}, 1.0)[kLayer], 0.0f);
  EXPECT_GT(terrain_features(deep, 1.0)[kLayer], 0.1f);
  EXPECT_GT(terrain_features(shallow, 1.0)[kLayer], 2.0f * terrain_features(deep, 1.0)[kLayer]);
}

}  // namespace
}  // namespace sandrunner::train
