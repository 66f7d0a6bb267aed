// SPDX-License-Identifier: BSD-3-Clause
// The training's longer step moves a robot as the step of a run does.
#include <gtest/gtest.h>

#include <cmath>

#include "rt/core/processor.h"
#include "sim/batch/batch.h"
#include "sim/ground/terrain_description.h"
#include "sim/robot/robot_model.h"
#include "tools/train/task/task.h"

namespace sandrunner::train {
namespace {

constexpr int kActions = 60, kRobots = 16;

struct Landing {
  double way_m = 0, height_m = 0, sinkage_m = 0;  ///< at the end, means over the robots
  double heat_nm2 = 0, power_w = 0;               ///< means over time and robots
};

/// Robots fall from up to 16 cm onto their feet, at up to 0.5 m/s forward, and bend their knees.
Landing land(sim::GroundKind kind, int steps_per_action) {
  flush_denormals_to_zero();
  const sim::Robot robot = sim::load_raibo();
  sim::TerrainDescription ground;
  ground.patches.push_back({0.0, {}});
  ground.patches[0].ground.kind = kind;
  const sim::FootProfile<double> foot = sim::make_foot_profile(ground, robot.model);
  sim::StepSettings settings;
  settings.dt_s = 1.0 / (kPolicyHz * steps_per_action);
  sim::Batch batch(kRobots, foot, settings, sim::BatchWidth::kOne);
  sim::BatchDrive<float> drive;
  drive.kp = 80.0f;
  drive.kd = 2.0f;
  sim::RobotState<float> start;
  for (int j = 0; j < kNumJoints; ++j) {
    start.rigid.q[j] = static_cast<float>(robot.nominal_rad[j]);
  }
  drive.target_before = drive.target = start.rigid.q;
  for (int i = 0; i < kRobots; ++i) {
    batch.set_model(i, sim::convert_model<float>(robot.model));
    batch.set_terrain(i, sim::convert_terrain<float>(sim::make_terrain(ground, foot, robot.model)));
    start.rigid.position.z = static_cast<float>(robot.nominal_height_m + 0.01 * (i + 1));
    start.rigid.velocity.x = 0.03f * static_cast<float>(i);
    batch.set_state(i, start);
    batch.set_drive(i, drive);
  }
  Landing mean;
  for (int action = 0; action < kActions; ++action) {
    for (int i = 0; i < kRobots; ++i) batch.advance(i, steps_per_action);
    for (int i = 0; i < kRobots; ++i) {
      const sim::BatchSums<float> sums = batch.sums(i);
      mean.heat_nm2 += double{sums.torque_squared} / (steps_per_action * kActions * kRobots);
      mean.power_w += std::fabs(double{sums.power}) / (steps_per_action * kActions * kRobots);
    }
  }
  for (int i = 0; i < kRobots; ++i) {
    mean.way_m += batch.state(i).rigid.position.x / kRobots;
    mean.height_m += batch.state(i).rigid.position.z / kRobots;
    for (const float depth : batch.report(i).penetration) mean.sinkage_m += depth / (4 * kRobots);
  }
  return mean;
}

void expect_alike(sim::GroundKind kind) {
  const Landing run = land(kind, kTicksPerPolicyStep), training = land(kind, kStepsPerAction);
  EXPECT_NEAR(training.way_m, run.way_m, 0.001);
  EXPECT_NEAR(training.height_m, run.height_m, 0.0015);
  EXPECT_NEAR(training.sinkage_m, run.sinkage_m, 0.0015);
  EXPECT_NEAR(training.heat_nm2, run.heat_nm2, 0.01 * run.heat_nm2);
  EXPECT_NEAR(training.power_w, run.power_w, 0.01 * run.power_w);
}

TEST(StepSizeTest, OnSandTheTrainingsRobotMovesLikeThatOfARun) {
  expect_alike(sim::GroundKind::kGranular);
}

TEST(StepSizeTest, OnHardGroundTheTrainingsRobotMovesLikeThatOfARun) {
  expect_alike(sim::GroundKind::kRigid);
}

}  // namespace
}  // namespace sandrunner::train
