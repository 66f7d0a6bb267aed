// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/dds/command_inbox.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/rt/telemetry/dds/support.h"

namespace sandrunner {
namespace {

// A robot that has been asked over DDS to stand up and walk, and two operators.
struct Walking : LiveSetup {
  Walking() : first(config), second(config), asker(first) {
    EXPECT_TRUE(asker.ask("arm").accepted);
    EXPECT_TRUE(asker.ask("stand").accepted);
    EXPECT_TRUE(wait_until([&] { return robot.mode() == Mode::kStand; }));
    EXPECT_TRUE(asker.ask("walk").accepted);
    EXPECT_EQ(robot.mode(), Mode::kWalk);
    twist = first.writer("rt/cmd_vel", geometry_msgs_msg_dds__Twist__desc);
  }
  // Sends this velocity until the robot has reached it; returns how many were sent.
  std::uint64_t drive_until(double vx_mps) {
    std::uint64_t sent = 0;
    EXPECT_TRUE(wait_until([&] {
      drive(twist, vx_mps);
      ++sent;
      return robot.speed_mps() == vx_mps;
    }));
    return sent;
  }
  Peer first, second;
  Asker asker;
  dds_entity_t twist;
};

sandrunner_ModeRequest request_of(const std::string& name) {
  sandrunner_ModeRequest request{};
  name.copy(request.request, sizeof request.request - 1);
  return request;
}

TEST(CommandInboxTest, NothingMovesUntilItIsAskedFor) {
  LiveSetup setup;
  Peer peer(setup.config);
  const auto twist = peer.writer("rt/cmd_vel", geometry_msgs_msg_dds__Twist__desc);
  for (int i = 0; i < 10; ++i) drive(twist, 1.0);
  ASSERT_TRUE(wait_until([&] { return setup.desk.counts().accepted == 10; }));
  ASSERT_TRUE(setup.robot.go_on());
  EXPECT_EQ(setup.robot.mode(), Mode::kPassive);
}

TEST(CommandInboxTest, ATwistDrivesAndWhenItStopsTheRobotSlowsDown) {
  Walking setup;
  const std::uint64_t sent = setup.drive_until(0.8);
  const std::uint64_t before_last = setup.robot.ticks();
  drive(setup.twist, 0.8);
  ASSERT_TRUE(wait_until([&] { return setup.desk.counts().accepted == sent + 1; }));
  EXPECT_EQ(setup.robot.speed_mps(), 0.8);
  // 0.3 s after the last one it slows down at 1 m/s^2; RemoteOperatorTest has the exact tick.
  const auto since_last_s = [&] {
    return static_cast<double>(setup.robot.ticks() - before_last) * kControlPeriod_s;
  };
  ASSERT_TRUE(wait_until([&] { return setup.robot.speed_mps() < 0.8; }));
  EXPECT_GE(since_last_s(), 0.3);
  ASSERT_TRUE(wait_until([&] { return setup.robot.speed_mps() == 0.0; }));
  EXPECT_GE(since_last_s(), 1.1);
  EXPECT_EQ(setup.robot.mode(), Mode::kWalk);
}

TEST(CommandInboxTest, ARobotThatWalksSlowsToAStandWhileASecondOneWouldObeyToo) {
  Walking setup;
  setup.drive_until(0.8);
  {
    Peer another(setup.config);
    another.writer("sandrunner/mode_reply", sandrunner_ModeReply_desc);
    ASSERT_TRUE(wait_until([&] {
      drive(setup.twist, 0.8);
      return setup.robot.speed_mps() == 0.0;
    }));
    EXPECT_GT(setup.desk.counts().objected, 0u);
    EXPECT_EQ(setup.robot.mode(), Mode::kWalk);
  }
  setup.drive_until(0.8);
}

TEST(CommandInboxTest, WhatIsNotFiniteOrAbsurdIsCountedAndChangesNothing) {
  Walking setup;
  drive(setup.twist, std::numeric_limits<double>::quiet_NaN());
  ASSERT_TRUE(wait_until([&] { return setup.desk.counts().not_finite == 1; }));
  drive(setup.twist, 1e9);
  ASSERT_TRUE(wait_until([&] { return setup.desk.counts().absurd == 1; }));
  ASSERT_TRUE(setup.robot.go_on());
  EXPECT_EQ(setup.desk.counts().accepted, 0u);
  EXPECT_EQ(setup.robot.speed_mps(), 0.0);
  EXPECT_EQ(setup.robot.mode(), Mode::kWalk);  // and not in Fault
}

TEST(CommandInboxTest, TheFirstOfTwoPublishersDrivesAndTheOtherTakesOverWhenItIsSilent) {
  Walking setup;
  const auto other = setup.second.writer("rt/cmd_vel", geometry_msgs_msg_dds__Twist__desc);
  auto last = std::chrono::steady_clock::now();
  for (std::uint64_t i = 1; i <= 20; ++i) {
    last = std::chrono::steady_clock::now();
    drive(setup.twist, 0.5);
    ASSERT_TRUE(wait_until([&] { return setup.desk.counts().accepted == i; }));
    drive(other, -0.5);
    ASSERT_TRUE(wait_until([&] { return setup.desk.counts().other_publisher == i; }));
    EXPECT_GE(setup.robot.speed_mps(), 0.0);
  }
  ASSERT_TRUE(wait_until([&] {
    drive(other, -0.5);
    return setup.desk.counts().accepted > 20;
  }));
  EXPECT_GE(std::chrono::steady_clock::now() - last, std::chrono::milliseconds(300));
  ASSERT_TRUE(wait_until([&] {
    drive(other, -0.5);
    return setup.robot.speed_mps() == -0.5;
  }));
}

TEST(CommandInboxTest, OneThatSendsRightAfterTheHolderDoesNotSilenceIt) {
  Walking setup;
  const auto other = setup.second.writer("rt/cmd_vel", geometry_msgs_msg_dds__Twist__desc);
  const auto start = std::chrono::steady_clock::now();
  std::uint64_t sent = 0;
  while (std::chrono::steady_clock::now() - start < std::chrono::milliseconds(400)) {  // over 0.3 s
    drive(setup.twist, 0.5);
    drive(other, -0.5);
    ++sent;
    ASSERT_TRUE(wait_until([&] { return setup.desk.counts().other_publisher == sent; }));
  }
  EXPECT_EQ(setup.desk.counts().accepted, sent);
  EXPECT_EQ(setup.robot.speed_mps(), 0.5);
}

TEST(CommandInboxTest, WhatWasLostOnTheWayDoesNotOvertakeTheStopAfterIt) {
  Walking setup;
  const dds_time_t before = dds_time();
  const auto again = setup.first.writer("sandrunner/mode_request", sandrunner_ModeRequest_desc);
  const sandrunner_ModeRequest walk = request_of("walk");
  EXPECT_TRUE(setup.asker.ask("stop").accepted);
  dds_write_ts(again, &walk, before);  // as it comes when it is sent once more
  ASSERT_TRUE(wait_until([&] { return setup.desk.counts().requests_refused == 1; }));
  EXPECT_NE(setup.desk.last_request().find("before the latest stop"), std::string::npos);
  ASSERT_TRUE(wait_until([&] { return setup.robot.mode() == Mode::kStand; }));
  dds_write_ts(again, &walk, dds_time());
  EXPECT_TRUE(wait_until([&] { return setup.robot.mode() == Mode::kWalk; }));
}

TEST(CommandInboxTest, OperatorWhoseClockIsSetBackAfterAStopIsObeyedAgainSoon) {
  Walking setup;
  const auto ahead = setup.first.writer("sandrunner/mode_request", sandrunner_ModeRequest_desc);
  const sandrunner_ModeRequest stop = request_of("stop");
  const auto before = std::chrono::steady_clock::now();
  dds_write_ts(ahead, &stop, dds_time() + DDS_SECS(60));
  ASSERT_TRUE(wait_until([&] { return setup.robot.mode() == Mode::kStand; }));
  EXPECT_TRUE(wait_until([&] { return setup.asker.ask("walk").accepted; }));
  EXPECT_GE(std::chrono::steady_clock::now() - before, std::chrono::seconds(1));
}

TEST(CommandInboxTest, FloodOfRequestsFromOnePeerLeavesTheOthersAnsweredAndVelocitiesRead) {
  Walking setup;
  const auto many = setup.first.writer("sandrunner/mode_request", sandrunner_ModeRequest_desc);
  std::atomic<bool> end{false};
  std::thread flood([&] {
    const sandrunner_ModeRequest arm = request_of("arm");  // refused: the drives are on
    while (!end) {                                         // some 10,000 a second
      for (int i = 0; i < 12; ++i) dds_write(many, &arm);
      sleep_s(0.001);
    }
  });
  Asker other(setup.second);
  for (const char* request : {"walk", "walk", "walk", "walk", "walk"}) {
    EXPECT_TRUE(other.ask(request).accepted);
  }
  const std::uint64_t before = setup.desk.counts().accepted;
  for (int i = 0; i < 20; ++i) drive(setup.twist, 0.5);
  EXPECT_TRUE(wait_until([&] { return setup.desk.counts().accepted == before + 20; }));
  EXPECT_TRUE(other.ask("damp").accepted);
  end = true;
  flood.join();
}

TEST(CommandInboxTest, StopBehindAFloodOfRequestsOfItsOwnSenderIsFollowed) {
  Walking setup;
  const auto many = setup.first.writer("sandrunner/mode_request", sandrunner_ModeRequest_desc);
  const sandrunner_ModeRequest walk = request_of("walk"), stop = request_of("stop");
  for (int i = 0; i < 500; ++i) dds_write(many, &walk);
  dds_write(many, &stop);
  EXPECT_TRUE(wait_until([&] { return setup.robot.mode() == Mode::kStand; }));
}

TEST(CommandInboxTest, StopAndDampAreTakenFromOneThatDoesNotHoldTheCommand) {
  Walking setup;
  Asker bystander(setup.second);
  setup.drive_until(0.5);
  EXPECT_TRUE(bystander.ask("stop").accepted);
  EXPECT_TRUE(wait_until([&] {
    drive(setup.twist, 0.5);  // the holder goes on as before
    return setup.robot.mode() == Mode::kStand;
  }));
  EXPECT_TRUE(setup.asker.ask("walk").accepted);
  const sandrunner_ModeReply damped = bystander.ask("damp");
  EXPECT_TRUE(damped.accepted);
  EXPECT_STREQ(damped.mode, "damping");
  EXPECT_EQ(setup.robot.mode(), Mode::kDamping);
}

TEST(CommandInboxTest, WhoeverHoldsTheCommandAloneMayAskForMore) {
  Walking setup;
  Asker bystander(setup.second);
  setup.drive_until(0.5);
  EXPECT_STREQ(bystander.ask("walk").reason, "another operator drives the robot");
  drive(setup.twist, 0.5);
  EXPECT_TRUE(setup.asker.ask("walk").accepted);
  // Who has been silent for the stale time holds nothing any more.
  EXPECT_TRUE(wait_until([&] { return bystander.ask("walk").accepted; }));
}

TEST(CommandInboxTest, RepliesSayWhyARequestIsRefused) {
  LiveSetup setup;
  Peer peer(setup.config);
  Asker asker(peer);
  const auto refused = [&](const char* request, const char* reason) {
    const sandrunner_ModeReply reply = asker.ask(request);
    EXPECT_FALSE(reply.accepted) << request;
    EXPECT_STREQ(reply.reason, reason);
    EXPECT_STREQ(reply.mode, mode_name(setup.robot.mode()));
  };
  refused("walk", "the robot does not stand, stand comes first");
  refused("stand", "the drives are off, arm comes first");
  refused("reset_fault", "no fault is latched");
  refused("dance", "unknown, expected arm, stand, walk, stop, lie, damp, disarm or reset_fault");
  // Stop makes no robot stand up.
  EXPECT_TRUE(asker.ask("stop").accepted);
  ASSERT_TRUE(setup.robot.go_on());
  EXPECT_EQ(setup.robot.mode(), Mode::kPassive);

  setup.robot.break_joint();
  ASSERT_TRUE(wait_until([&] { return setup.robot.mode() == Mode::kFault; }));
  refused("stand", "a fault is latched, reset_fault comes first");
  refused("reset_fault", "the fault still holds, or the drives are still damping");
  setup.robot.mend_joint();
  ASSERT_TRUE(setup.robot.go_on());
  const sandrunner_ModeReply reset = asker.ask("reset_fault");
  EXPECT_TRUE(reset.accepted) << reset.reason;
  EXPECT_STREQ(reset.mode, "passive");
  EXPECT_EQ(setup.desk.counts().requests_refused, 6u);
  EXPECT_EQ(setup.desk.counts().requests_accepted, 2u);
}

TEST(CommandInboxTest, WithoutAPolicyNobodyWalks) {
  LiveSetup setup(test_config(), "no policy to walk with");
  Peer peer(setup.config);
  Asker asker(peer);
  EXPECT_TRUE(asker.ask("arm").accepted);
  EXPECT_TRUE(asker.ask("stand").accepted);
  ASSERT_TRUE(wait_until([&] { return setup.robot.mode() == Mode::kStand; }));
  EXPECT_STREQ(asker.ask("walk").reason, "no policy to walk with");
}

TEST(CommandInboxTest, ARequestToAControllerThatDoesNotRunIsRefusedAndNotDoneLater) {
  const DdsConfig config = test_config();
  for (const auto& [request, later] :
       {std::pair("arm", ModeRequest::kNone), {"damp", ModeRequest::kDamp}}) {
    DdsParticipant participant(config);
    RemoteOperator op(config.stale_ticks());
    OperatorDesk desk(op, config.stale_s, nullptr);
    CommandInbox inbox(participant, config, "example@here", desk);
    Peer peer(config);
    EXPECT_STREQ(Asker(peer).ask(request).reason, "the controller does not answer");
    op.command(0);
    EXPECT_EQ(op.command(1).request, later) << request;  // a damp still holds
  }
}

TEST(CommandInboxTest, ADampThatWaitsForTheControllerIsNotReplacedByAWalk) {
  const DdsConfig config = test_config();
  DdsParticipant participant(config);
  RemoteOperator op(config.stale_ticks());
  OperatorDesk desk(op, config.stale_s, nullptr);
  CommandInbox inbox(participant, config, "example@here", desk);
  Peer peer(config);
  Asker asker(peer);
  for (const char* request : {"damp", "arm", "walk"}) {
    EXPECT_STREQ(asker.ask(request).reason, "the controller does not answer") << request;
  }
  op.command(0);
  EXPECT_EQ(op.command(1).request, ModeRequest::kDamp);
}

TEST(CommandInboxTest, TwistStampedIsTakenIfTheConfigSaysSo) {
  DdsConfig config = test_config();
  config.stamped_cmd_vel = true;
  LiveSetup setup(config);
  Peer peer(config);
  const auto writer = peer.writer("rt/cmd_vel", geometry_msgs_msg_dds__TwistStamped__desc);
  geometry_msgs_msg_dds__TwistStamped_ twist{};
  char frame[] = "base_link";
  twist.header.frame_id = frame;
  twist.header.stamp.sec = 1;  // long ago, which is ignored
  twist.twist.linear.x = 0.5;
  dds_write(writer, &twist);
  EXPECT_TRUE(wait_until([&] { return setup.desk.counts().accepted == 1; }));
}

}  // namespace
}  // namespace sandrunner
