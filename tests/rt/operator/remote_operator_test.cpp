// SPDX-License-Identifier: BSD-3-Clause
#include "rt/operator/remote_operator.h"

#include <gtest/gtest.h>

#include "tests/rt/core/fake_robot.h"

namespace sandrunner {
namespace {

constexpr std::uint64_t kStale_ticks = 1200;

TEST(RemoteOperatorTest, ARobotWhoseOperatorSaysNothingStaysPassive) {
  RemoteOperator op(kStale_ticks);
  for (std::uint64_t tick = 0; tick < 100; ++tick) {
    const OperatorCommand command = op.command(tick);
    EXPECT_EQ(command.request_id, 0u);
    EXPECT_EQ(command.velocity.vx_mps, 0.0);
    EXPECT_TRUE(op.advance({.mode = Mode::kPassive}).goes_on());
  }
}

TEST(RemoteOperatorTest, AVelocityAgesInTicksFromWhenItWasFirstSeen) {
  RemoteOperator op(kStale_ticks);
  op.command(99);
  op.ask({.velocity = {.vx_mps = 1.0}, .velocity_number = 1});
  EXPECT_EQ(op.command(100).velocity.vx_mps, 1.0);
  const OperatorCommand last = op.command(100 + kStale_ticks);
  EXPECT_EQ(last.velocity.vx_mps, 1.0);
  EXPECT_EQ(last.tick, 100u);
  const OperatorCommand stale = op.command(101 + kStale_ticks);
  EXPECT_EQ(stale.velocity.vx_mps, 0.0);
  EXPECT_EQ(stale.tick, 100u);  // for the controller's own judgement
}

TEST(RemoteOperatorTest, ARequestDoesNotRefreshTheVelocity) {
  RemoteOperator op(kStale_ticks);
  OperatorRequests asked{.velocity = {.vx_mps = 1.0}, .velocity_number = 1};
  op.ask(asked);
  op.command(0);
  asked.request = ModeRequest::kDamp;
  asked.request_number = 1;
  op.ask(asked);
  const OperatorCommand command = op.command(kStale_ticks + 1);
  EXPECT_EQ(command.velocity.vx_mps, 0.0);
  EXPECT_EQ(command.request, ModeRequest::kDamp);
}

TEST(RemoteOperatorTest, ACommandThatCameDuringMissedSlotsIsAsOldAsTheFirstOfThem) {
  RemoteOperator op(kStale_ticks);
  op.command(10);
  op.ask({.velocity = {.vx_mps = 1.0}, .velocity_number = 1});
  EXPECT_EQ(op.command(1000).tick, 11u);
}

TEST(RemoteOperatorTest, TheControllersFirstStepGetsNoRequestAndTheNextOneDoes) {
  RemoteOperator op(kStale_ticks);
  op.ask({.velocity = {}, .request = ModeRequest::kStand, .request_number = 1});
  EXPECT_EQ(op.command(0).request_id, 0u);
  op.advance({.mode = Mode::kPassive});
  EXPECT_EQ(op.considered(), 0u);
  EXPECT_EQ(op.command(1).request_id, 1u);
  op.advance({.mode = Mode::kStandUp});
  EXPECT_EQ(op.considered(), 1u);
  EXPECT_EQ(op.mode(), Mode::kStandUp);
}

TEST(RemoteOperatorTest, AnInterruptLiesDownThenDampsForASecondAndTakesNoMoreRequests) {
  RemoteOperator op(kStale_ticks);
  op.command(0);
  EXPECT_TRUE(op.advance({.mode = Mode::kStand, .interrupts = 1}).goes_on());
  op.ask({.velocity = {}, .request = ModeRequest::kWalk, .request_number = 1});
  const OperatorCommand command = op.command(1);
  EXPECT_EQ(command.request, ModeRequest::kLie);
  EXPECT_EQ(command.request_id, 1u);
  for (int n = 0; n < 6000; ++n) {
    ASSERT_TRUE(op.advance({.mode = Mode::kStand, .interrupts = 1}).goes_on());
  }
  int ticks = 1;
  while (op.advance({.mode = Mode::kDamping, .interrupts = 1}).goes_on()) ++ticks;
  EXPECT_EQ(ticks, kControlHz);
  EXPECT_EQ(op.command(2).request_id, 1u);
}

TEST(RemoteOperatorTest, AnOperatorMayDampARobotWhoseRunEnds) {
  RemoteOperator op(kStale_ticks);
  op.command(0);
  op.advance({.mode = Mode::kStand, .interrupts = 1});
  EXPECT_EQ(op.command(1).request, ModeRequest::kLie);
  op.ask({.velocity = {}, .request = ModeRequest::kDamp, .request_number = 1});
  EXPECT_EQ(op.command(2).request, ModeRequest::kDamp);
  op.advance({.mode = Mode::kDamping, .interrupts = 1});
  EXPECT_EQ(op.considered(), 1u);
}

TEST(RemoteOperatorTest, ASecondInterruptDampsAtOnce) {
  RemoteOperator op(kStale_ticks);
  op.command(0);
  op.advance({.mode = Mode::kWalk, .interrupts = 1});
  op.advance({.mode = Mode::kWalk, .interrupts = 2});
  EXPECT_EQ(op.command(1).request, ModeRequest::kDamp);
}

TEST(RemoteOperatorTest, AnInterruptedRobotWithItsDrivesOffEndsAtOnce) {
  RemoteOperator op(kStale_ticks);
  op.command(0);
  EXPECT_FALSE(op.advance({.mode = Mode::kPassive, .interrupts = 1}).goes_on());
}

}  // namespace
}  // namespace sandrunner
