// SPDX-License-Identifier: BSD-3-Clause
#include "rt/operator/return_to_stand.h"

#include <gtest/gtest.h>

#include "rt/operator/remote_operator.h"

namespace sandrunner {
namespace {

struct ReturnToStandTest : testing::Test {
  /// A tick in this mode; what is asked for in it.
  OperatorCommand tick(Mode mode) {
    const OperatorCommand command = op.command(next++);
    op.advance({.mode = mode});
    return command;
  }
  RemoteOperator other{1200};
  ReturnToStand op{other};
  std::uint64_t next = 1;
};

TEST_F(ReturnToStandTest, UntilItIsToldTheOtherOperatorSpeaks) {
  tick(Mode::kStand);
  other.ask({.velocity = {.vx_mps = 1.0},
             .velocity_number = 1,
             .request = ModeRequest::kWalk,
             .request_number = 1});
  const OperatorCommand command = tick(Mode::kWalk);
  EXPECT_EQ(command.request, ModeRequest::kWalk);
  EXPECT_EQ(command.request_id, 1u);
  EXPECT_EQ(command.velocity.vx_mps, 1.0);
  EXPECT_FALSE(op.holds());
}

TEST_F(ReturnToStandTest, AWalkingRobotIsDampedPutUprightStandsUpAndIsHeldUntilItDoes) {
  tick(Mode::kWalk);
  op.begin();
  const std::uint64_t damp = tick(Mode::kDamping).request_id;
  EXPECT_EQ(tick(Mode::kDamping).request, ModeRequest::kDamp);
  EXPECT_EQ(tick(Mode::kDamping).request_id, damp);
  EXPECT_TRUE(op.holds());
  op.is_upright();
  tick(Mode::kDamping);
  EXPECT_EQ(tick(Mode::kStandUp).request, ModeRequest::kStand);
  EXPECT_FALSE(op.holds());
  const std::uint64_t id = tick(Mode::kStand).request_id;
  EXPECT_EQ(tick(Mode::kStand).request_id, id);
}

TEST_F(ReturnToStandTest, AFaultIsResetAgainAndAgainAsTheControllerDampsFirst) {
  tick(Mode::kFault);
  op.begin();
  op.is_upright();
  tick(Mode::kFault);
  const OperatorCommand first = tick(Mode::kFault);
  EXPECT_EQ(first.request, ModeRequest::kResetFault);
  std::uint64_t id = first.request_id;
  for (int i = 0; i < kControlHz; ++i) id = tick(Mode::kFault).request_id;
  EXPECT_EQ(id, first.request_id + 4);
  tick(Mode::kPassive);
  EXPECT_EQ(tick(Mode::kDamping).request, ModeRequest::kArm);
  EXPECT_TRUE(op.holds());
}

TEST_F(ReturnToStandTest, ADampOfTheOtherOperatorEndsIt) {
  tick(Mode::kPassive);
  op.begin();
  tick(Mode::kDamping);
  other.ask({.velocity = {}, .request = ModeRequest::kDamp, .request_number = 1});
  EXPECT_EQ(tick(Mode::kDamping).request, ModeRequest::kDamp);
  EXPECT_FALSE(op.holds());
  EXPECT_EQ(tick(Mode::kDamping).request, ModeRequest::kDamp);
}

TEST_F(ReturnToStandTest, WhatDoesNotStandWithinTenSecondsIsLetGo) {
  op.begin();
  for (int i = 0; i < 10 * kControlHz; ++i) tick(Mode::kFault);
  EXPECT_TRUE(op.holds());
  tick(Mode::kFault);
  EXPECT_FALSE(op.holds());
}

}  // namespace
}  // namespace sandrunner
