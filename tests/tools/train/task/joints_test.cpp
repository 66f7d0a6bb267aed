// SPDX-License-Identifier: BSD-3-Clause
// How the joints of a training's robots differ: friction, rotors, and the delay of their targets.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "rt/core/processor.h"
#include "tools/train/task/robot_settings.h"
#include "tools/train/task/task.h"

namespace sandrunner::train {
namespace {

constexpr int kWalkers = 64;

std::vector<sim::BatchRobot<float>> robots_of(const Task& task) {
  std::vector<sim::BatchRobot<float>> robots;
  for (int env = 0; env < kWalkers; ++env) robots.push_back(task.batch().robot(env));
  return robots;
}

TEST(JointsTest, OfGo2HaveFrictionAndRotorsOfTheirOwn) {
  flush_denormals_to_zero();
  const sim::Robot go2 = sim::load_robot("go2");
  const TaskConfig config = shipped_task_config(go2);
  const auto robots = robots_of(Task(config, go2, {kWalkers, kWalkers}, 1));
  const auto extremes = [&](auto figure) {
    const auto [least, most] = std::ranges::minmax_element(robots, {}, figure);
    return std::pair{figure(*least), figure(*most)};
  };
  const auto [smooth, rough] = extremes([](const auto& r) { return r.model.friction_nm[4]; });
  EXPECT_GE(smooth, 0.0f);
  EXPECT_LT(smooth, 0.05f);
  EXPECT_GT(rough, 0.35f);
  EXPECT_LE(rough, 0.4f);
  for (int j = 0; j < kJointsPerLeg; ++j) {
    const auto [light, heavy] = extremes([&](const auto& r) {
      return r.model.rotor_inertia[j] / static_cast<float>(go2.model.rotor_inertia[j]);
    });
    EXPECT_NEAR(light, config.robot.rotor_inertia_low, 0.1) << j;
    EXPECT_NEAR(heavy, config.robot.rotor_inertia_high, 0.3) << j;
  }
  for (const auto& robot : robots) {
    EXPECT_EQ(robot.model.rotor_inertia[1], robot.model.rotor_inertia[10]);
  }
}

TEST(JointsTest, OfARobotWithoutFrictionHaveNone) {
  flush_denormals_to_zero();
  const sim::Robot raibo = sim::load_raibo();
  for (const auto& robot :
       robots_of(Task(shipped_task_config(raibo), raibo, {kWalkers, kWalkers}, 1))) {
    EXPECT_EQ(robot.model.friction_nm, (JointArray<float>{}));
    EXPECT_EQ(robot.model.rotor_inertia[0], static_cast<float>(raibo.model.rotor_inertia[0]));
  }
}

/// Step of a training, of 10 ms, in which the drives first have the targets of the first action,
/// and the share of that step that was over by then.
std::pair<int, float> arrival(double latency_s) {
  flush_denormals_to_zero();
  const sim::Robot raibo = sim::load_raibo();
  TaskConfig config = shipped_task_config(raibo);
  config.robot.latency_s.fill(latency_s);
  Task task(config, raibo, {kWalkers, kWalkers}, 1);
  learner::Rollout rollout({kWalkers, 3, Task::privileged_size()}, 1);
  task.observe(0, 0, rollout);
  for (int t = 0; t < 3; ++t) {
    rollout.action(t).setOnes();
    task.step(0, t, rollout);
    if (rollout.reset(t + 1, 0) != 0) return {-1, 0.0f};
    const auto robots = robots_of(task);
    const sim::BatchDrive<float>& drive = robots[0].drive;
    if (drive.target == drive.target_before) continue;
    const float share = drive.switch_tick / kStepsPerAction;
    if (share < 1.0f) return {t, share};
  }
  return {-1, 0.0f};
}

TEST(JointsTest, GetTheirTargetsAfterTheDelay) {
  EXPECT_EQ(arrival(0.0), (std::pair{0, 0.0f}));
  EXPECT_EQ(arrival(0.005), (std::pair{0, 0.5f}));
  EXPECT_EQ(arrival(0.015), (std::pair{1, 0.5f}));
}

}  // namespace
}  // namespace sandrunner::train
