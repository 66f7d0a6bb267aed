// SPDX-License-Identifier: BSD-3-Clause
// What the environments stand on, and by which robots the curricula open.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "rt/core/processor.h"
#include "tools/train/task/robot_settings.h"
#include "tools/train/task/task.h"

namespace sandrunner::train {
namespace {

constexpr int kEnvs = 64;

/// A task whose curricula open in one window, whatever the robots do.
TaskConfig open_at_once() {
  flush_denormals_to_zero();
  TaskConfig config = shipped_task_config(sim::load_raibo());
  config.command.gate_kernel = config.ground.gate_kernel = -1.0;
  config.command.gate_falls = config.ground.gate_falls = 1e9;
  config.command.speed_start_mps = 1.0;
  config.command.speed_step_mps = 3.0;
  config.command.zero_share = config.command.in_place_share = 0.0;
  config.command.forward_share = 1.0;
  config.ground.open_step = 1.0;
  config.episode.reset_nominal_share = 0.0;
  return config;
}

Task task_with(const TaskConfig& config, int steps) {
  Task task(config, sim::load_raibo(), {kEnvs, kEnvs}, 1);
  learner::Rollout rollout{{kEnvs, steps, Task::privileged_size()}, 1};
  task.observe(0, 0, rollout);
  for (int t = 0; t < steps; ++t) {
    rollout.action(t).setZero();
    task.step(0, t, rollout);
  }
  return task;
}

std::vector<sim::Ground<float>> patches_of(const Task& task) {
  std::vector<sim::Ground<float>> patches;
  for (int env = 0; env < kEnvs; ++env) {
    const sim::Terrain<float>& terrain = task.terrain(env);
    patches.insert(patches.end(), terrain.ground.begin(),
                   terrain.ground.begin() + static_cast<int>(terrain.count));
  }
  return patches;
}

sim::GroundKind kind_of(const sim::Ground<float>& patch) {
  return static_cast<sim::GroundKind>(patch.kind);
}

TEST(CurriculumTest, OpensOnHardGroundAloneAndOnGroundThatYields) {
  for (const int rigid : {kEnvs, kEnvs / 4, 0}) {
    TaskConfig config = open_at_once();
    config.ground.rigid_envs = rigid;
    config.ground.patchy_envs = 0;
    Task task = task_with(config, 20);
    task.end_window(0.0, 0.0);
    EXPECT_EQ(task.curriculum().speed_mps, 4.0) << rigid << " robots on hard ground";
    EXPECT_EQ(task.curriculum().ground, 1.0) << rigid << " robots on hard ground";
  }
}

TEST(CurriculumTest, LooksAtGroundThatYieldsIfThereIsAny) {
  // Soil that carries nothing: all fall there, and none on hard ground.
  TaskConfig config = open_at_once();
  config.episode.reset_nominal_share = 1.0;
  config.episode.push_probability = 0.0;
  config.ground.patchy_envs = 0;
  config.ground.sigma_flat_low_start = config.ground.sigma_flat_high = 1.0;
  config.ground.sigma_cone_low_start = config.ground.sigma_cone_high = 1.0;
  config.ground.inertial_low = config.ground.inertial_high = 0.0;
  config.ground.gate_falls = 0.1;
  for (const int rigid : {kEnvs, kEnvs / 4}) {
    config.ground.rigid_envs = rigid;
    Task task = task_with(config, 60);
    task.end_window(0.0, 0.0);
    EXPECT_EQ(task.curriculum().ground, rigid == kEnvs ? 1.0 : 0.0) << rigid;
  }
}

TEST(YieldingGroundTest, SpringsHaveStiffnessesAndDampingWithinTheirRange) {
  TaskConfig config = open_at_once();
  config.ground.yielding = sim::GroundKind::kLinear;
  const double quarter_kg = sim::load_raibo().model.mass() / kNumLegs;
  const auto check = [&](const Task& task, double softest_npm) {
    int springs = 0;
    double least = 1e9, most = 0.0;
    for (const sim::Ground<float>& patch : patches_of(task)) {
      EXPECT_NE(kind_of(patch), sim::GroundKind::kGranular);
      if (kind_of(patch) != sim::GroundKind::kLinear) continue;
      ++springs;
      const double ratio = patch.damping / (2.0 * std::sqrt(patch.stiffness * quarter_kg));
      EXPECT_GE(ratio, 0.0999);
      EXPECT_LE(ratio, 1.0001);
      least = std::min(least, static_cast<double>(patch.stiffness));
      most = std::max(most, static_cast<double>(patch.stiffness));
    }
    EXPECT_GT(springs, kEnvs / 2);
    EXPECT_GE(least, 0.999 * softest_npm / config.ground.patch_loose_factor);
    EXPECT_LE(most, 33.001e3);
    return least;
  };
  config.ground.open_step = 0.0;
  EXPECT_GT(check(task_with(config, 1), 10e3), 2e3);
  // Patches that are softer begin at the softest of the others.
  config.ground.patch_loose_share = 0.0;
  EXPECT_GT(check(task_with(config, 1), 10e3), 9.99e3);
}

TEST(YieldingGroundTest, SoilWithoutInertiaHasNeitherAddedMassNorDrag) {
  TaskConfig config = open_at_once();
  config.ground.inertial_low = config.ground.inertial_high = 0.0;
  int soils = 0;
  for (const sim::Ground<float>& patch : patches_of(task_with(config, 1))) {
    if (kind_of(patch) != sim::GroundKind::kGranular) continue;
    ++soils;
    EXPECT_EQ(patch.added_mass, 0.0f);
    EXPECT_EQ(patch.drag, 0.0f);
    EXPECT_GT(patch.sigma_flat, 0.0f);
  }
  EXPECT_GT(soils, kEnvs / 2);
}

}  // namespace
}  // namespace sandrunner::train
