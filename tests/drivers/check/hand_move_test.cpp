// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/check/hand_move.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/robot/robot_model.h"
#include "tests/drivers/robot/example.h"

namespace sandrunner {
namespace {

using Verdict = HandMove::Verdict;

/// Joints that turn evenly by `moved_rad` in 100 exchanges.
JointTrace trace_of(const JointArray<double>& moved_rad) {
  JointTrace trace(101);
  for (int i = 0; i <= 100; ++i) {
    for (int j = 0; j < kNumJoints; ++j) trace[i][j] = 0.3 * j + 0.01 * i * moved_rad[j];
  }
  return trace;
}

TEST(HandMoveTest, DirectionsComeFromTheRobotsLinksAndAxes) {
  const sim::Robot raibo = sim::load_raibo();
  const auto motion = [&](int j) {
    return positive_motion(raibo.description, raibo.nominal_rad, j);
  };
  EXPECT_EQ(motion(0), "LF_FOOT goes to the left");
  EXPECT_EQ(motion(3), "RF_FOOT goes to the left");
  EXPECT_EQ(motion(1), "LF_FOOT goes backward");
  EXPECT_EQ(motion(8), "LH_FOOT goes backward and down");
}

TEST(HandMoveTest, DirectionsFollowAnAxisThatPointsTheOtherWay) {
  RobotDescription robot = sim::load_raibo().description;
  for (RobotFrame& frame : robot.frames) {
    for (double& component : frame.axis) component = -component;
  }
  EXPECT_EQ(positive_motion(robot, JointArray<double>{}, 0), "LF_FOOT goes to the right");
  EXPECT_EQ(positive_motion(robot, JointArray<double>{}, 1), "LF_FOOT goes forward");
}

TEST(HandMoveTest, AJointThatTurnsAsItShouldIsGood) {
  const HandMove move = judge_move(trace_of({0.0, 0.45, 0.1}), 1);
  EXPECT_EQ(move.verdict, Verdict::kGood);
  EXPECT_EQ(move.joint, 1);
  EXPECT_NEAR(move.moved_rad, 0.45, 1e-9);
}

TEST(HandMoveTest, WhatIsWrongIsTold) {
  EXPECT_EQ(judge_move({}, 1).verdict, Verdict::kNotMoved);
  EXPECT_EQ(judge_move(trace_of({0.0, 0.03}), 1).verdict, Verdict::kNotMoved);
  EXPECT_EQ(judge_move(trace_of({0.0, -0.5}), 1).verdict, Verdict::kWrongSign);
  EXPECT_EQ(judge_move(trace_of({0.0, 0.5 * 9.0}), 1).verdict, Verdict::kWrongScale);
  EXPECT_EQ(judge_move(trace_of({0.0, 0.5 / 6.28}), 1).verdict, Verdict::kWrongScale);
  EXPECT_EQ(judge_move(trace_of({0.0, 0.45 * 2.0}), 1).verdict, Verdict::kWrongScale);
  EXPECT_EQ(judge_move(trace_of({0.0, 0.55 / 2.0}), 1).verdict, Verdict::kWrongScale);
  const HandMove swapped = judge_move(trace_of({0.0, 0.05, 0.0, 0.0, 0.5}), 1);
  EXPECT_EQ(swapped.verdict, Verdict::kOtherJoint);
  EXPECT_EQ(swapped.joint, 4);
}

TEST(HandMoveTest, AJointThatWasTurnedAndTurnedBackHasNoSign) {
  JointTrace trace = trace_of({0.0, 0.5});
  trace.insert(trace.end(), trace.rbegin(), trace.rend());
  EXPECT_EQ(judge_move(trace, 1).verdict, Verdict::kWrongScale);
}

TEST(HandMoveTest, WordsNameDriveAndRemedy) {
  const HardwareConfig config = example_hardware("mit");
  const RobotDescription robot = example_robot();
  const auto words = [&](const JointArray<double>& moved_rad) {
    return move_words(judge_move(trace_of(moved_rad), 1), 1, config, robot);
  };
  EXPECT_EQ(words({0.0, 0.5}), "LF_HFE (can0 id 2): turned by 0.50 rad, as it should");
  EXPECT_EQ(words({0.0, -0.5}),
            "LF_HFE (can0 id 2): turned by -0.50 rad, the other way: set sign = -1");
  EXPECT_THAT(words({0.0, 0.0, 0.0, 0.5}),
              testing::HasSubstr("the drive of RF_HAA (can1 id 1) turned, by 0.50 rad: swap"));
}

}  // namespace
}  // namespace sandrunner
