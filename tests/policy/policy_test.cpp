// SPDX-License-Identifier: BSD-3-Clause
#include "policy/policy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "tests/policy/allocation_counter.h"
#include "tests/policy/random_policy.h"
#include "tests/support/error_of.h"

namespace sandrunner {
namespace {

class PolicyTest : public testing::Test {
 protected:
  const PolicyFile file_ = random_policy_file();
  const Network network_{file_.parameters};
  const std::array<float, kObservationSize> observation_ = RandomFloats(9).observation();

  NetworkOutput network_output() const {
    NetworkState state;
    NetworkOutput output;
    network_.step(observation_, state, output);
    return output;
  }
};

TEST_F(PolicyTest, IsRefusedForARobotWithOtherJoints) {
  RobotDescription robot;
  robot.name = "cart";
  robot.joint_names = file_.spec.joint_names;
  EXPECT_NO_THROW(require_joints(file_.spec, robot));
  std::swap(robot.joint_names[3], robot.joint_names[4]);
  EXPECT_EQ(error_of([&] { require_joints(file_.spec, robot); }),
            "policy 'random' is for another robot: found joint 4 'RF_HAA', expected 'RF_HFE' "
            "of robot 'cart'; train one with sandrunner-train --robot FILE, or let it only "
            "stand with --policy none");
}

TEST_F(PolicyTest, TargetIsNominalPlusScaledAction) {
  const JointArray<double> target = Policy(file_.spec, network_).step(observation_).target_rad;
  const NetworkOutput output = network_output();
  for (int i = 0; i < kNumJoints; ++i) {
    EXPECT_DOUBLE_EQ(target[i], file_.spec.nominal_position_rad[i] + 0.1 * output.action[i]);
  }
}

TEST_F(PolicyTest, ActionIsLimitedWhereTheSpecSaysSo) {
  PolicySpec spec = file_.spec;
  spec.action_clip = 0.05;
  const JointArray<double> target = Policy(spec, network_).step(observation_).target_rad;
  const NetworkOutput output = network_output();
  int limited = 0;
  for (int i = 0; i < kNumJoints; ++i) {
    const double action = std::fmin(std::fmax(output.action[i], -0.05), 0.05);
    EXPECT_DOUBLE_EQ(target[i], spec.nominal_position_rad[i] + 0.1 * action);
    limited += std::abs(output.action[i]) > 0.05;
  }
  EXPECT_GT(limited, 0);
}

TEST_F(PolicyTest, EstimateIsInPhysicalUnitsAndOrder) {
  const StateEstimate estimate = Policy(file_.spec, network_).step(observation_).estimate;
  const NetworkOutput output = network_output();
  const auto physical = [&](int i) {
    return 0.5 * output.estimate_raw[i] + file_.spec.estimate_mean[i];
  };
  EXPECT_DOUBLE_EQ(estimate.body_height_m, physical(0));
  EXPECT_DOUBLE_EQ(estimate.velocity_mps[2], physical(3));
  EXPECT_DOUBLE_EQ(estimate.foot_height_m[0], physical(4));
  EXPECT_DOUBLE_EQ(estimate.foot_height_m[3], physical(7));
}

TEST_F(PolicyTest, ResetClearsTheMemory) {
  Policy policy(file_.spec, network_);
  const JointArray<double> first = policy.step(observation_).target_rad;
  EXPECT_NE(policy.step(observation_).target_rad, first);
  policy.reset();
  EXPECT_EQ(policy.step(observation_).target_rad, first);
}

TEST_F(PolicyTest, RestoredStateContinuesToTheSameBits) {
  Policy policy(file_.spec, network_);
  policy.step(observation_);
  const NetworkState state = policy.state();
  const JointArray<double> second = policy.step(observation_).target_rad;
  Policy other(file_.spec, network_);
  other.set_state(state);
  EXPECT_EQ(other.step(observation_).target_rad, second);
}

TEST_F(PolicyTest, StepDoesNotAllocate) {
  Policy policy(file_.spec, network_);
  const std::size_t before = number_of_allocations();
  policy.step(observation_);
  policy.reset();
  policy.step(observation_);
  EXPECT_EQ(number_of_allocations(), before);
}

}  // namespace
}  // namespace sandrunner
