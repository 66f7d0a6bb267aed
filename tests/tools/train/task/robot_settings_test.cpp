// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/task/robot_settings.h"

#include <gtest/gtest.h>

#include "tests/support/small_robot.h"
#include "tools/train/task/task_config.h"

namespace sandrunner::train {
namespace {

TaskConfig settings_of(const sim::Robot& robot) {
  ConfigTree tree;
  add_training_layers(tree, robot);
  return read_task_config(tree);
}

TEST(RobotSettingsTest, TheShippedRobotGetsTheFiguresItsTrainingWasTunedWith) {
  const TaskConfig config = settings_of(sim::load_raibo());
  EXPECT_NEAR(config.policy.kp_nmprad, 50.0, 1e-9);
  EXPECT_NEAR(config.command.speed_max_mps, 4.0, 1e-9);
  EXPECT_NEAR(config.reward.penalties.Energy::torque_weight, 1.0e-3, 1e-6);
  EXPECT_NEAR(config.reward.penalties.Energy::power_weight, 8.0e-3, 1e-5);
  EXPECT_NEAR(config.reward.penalties.JointMargin::knee_low_rad, -2.35, 1e-3);
  EXPECT_NEAR(config.reward.penalties.Height::target_m, 0.475, 1e-9);
}

TEST(RobotSettingsTest, Go2HasSettingsOfItsOwnOverTheDerivedOnes) {
  const TaskConfig config = settings_of(sim::load_robot("go2"));
  EXPECT_EQ(config.policy.kp_nmprad, 30.0);        // derived
  EXPECT_EQ(config.command.speed_max_mps, 2.5);    // its own
  EXPECT_EQ(config.robot.latency_s.back(), 0.02);  // likewise
}

TEST(RobotSettingsTest, SensorsAreAsNoisyAsThoseOfAnEvaluation) {
  const NoiseSettings training = settings_of(sim::load_raibo()).noise;
  const sim::ObservationNoise evaluation;
  EXPECT_EQ(training.gravity, evaluation.gravity);
  EXPECT_EQ(training.angular_velocity_radps, evaluation.angular_velocity_radps);
  EXPECT_EQ(training.joint_position_rad, evaluation.joint_position_rad);
  EXPECT_EQ(training.joint_velocity_radps, evaluation.joint_velocity_radps);
}

TEST(RobotSettingsTest, ARobotThatStandsAskewIsNotTrained) {
  sim::Robot robot = sim::load_raibo();
  const TaskConfig config = settings_of(robot);
  EXPECT_NO_THROW(check_robot(config, robot));
  robot.nominal_rad[0] = 0.1;
  EXPECT_THROW(check_robot(config, robot), InputError);
  robot.nominal_rad[3] = -0.1;
  EXPECT_NO_THROW(check_robot(config, robot));
  robot.nominal_rad[11] += 0.1;
  EXPECT_THROW(check_robot(config, robot), InputError);
}

TEST(RobotSettingsTest, LegsThatTurnDifferentWaysAreNotTrained) {
  sim::Robot robot = sim::load_raibo();
  const TaskConfig config = settings_of(robot);
  for (auto& leg : robot.model.legs) leg.sign[2] = -1.0;
  EXPECT_NO_THROW(check_robot(config, robot));
  robot.model.legs[1].sign[1] = -1.0;
  EXPECT_THROW(check_robot(config, robot), InputError);
}

TEST(RobotSettingsTest, AbductionMayTurnTheOtherWayOnTheRight) {
  sim::Robot robot = sim::load_raibo();
  const TaskConfig config = settings_of(robot);
  robot.model.legs[1].sign[0] = -1.0;
  EXPECT_THROW(check_robot(config, robot), InputError);
  robot.model.legs[3].sign[0] = -1.0;
  EXPECT_NO_THROW(check_robot(config, robot));
  robot.nominal_rad[0] = robot.nominal_rad[3] = 0.1;
  EXPECT_NO_THROW(check_robot(config, robot));
}

TEST(RobotSettingsTest, StopsMayBeMoreThanATurnAway) {
  sim::Robot robot = sim::load_raibo();
  robot.model.lower_rad[2] = -9.42;
  robot.model.upper_rad[2] = 9.42;
  EXPECT_NO_THROW(settings_of(robot));
}

TEST(RobotSettingsTest, ASmallerRobotIsSlowerLowerAndItsTorquePenalisedMore) {
  const TemporaryFolder folder;
  const TaskConfig raibo = settings_of(sim::load_raibo()),
                   small = settings_of(sim::load_robot(write_small_robot(folder)));
  EXPECT_LT(small.command.speed_max_mps, raibo.command.speed_max_mps);
  EXPECT_LT(small.reward.penalties.Height::target_m, raibo.reward.penalties.Height::target_m);
  EXPECT_LT(small.reward.penalties.penalty::Clearance<0>::target_m,
            raibo.reward.penalties.penalty::Clearance<0>::target_m);
  EXPECT_GT(small.reward.penalties.Energy::torque_weight,
            raibo.reward.penalties.Energy::torque_weight);
  EXPECT_GT(small.reward.penalties.Energy::power_weight,
            raibo.reward.penalties.Energy::power_weight);
}

}  // namespace
}  // namespace sandrunner::train
