// SPDX-License-Identifier: BSD-3-Clause
// A page and a publisher of DDS at the desk of one robot.
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "rt/telemetry/view/view_server.h"
#include "tests/rt/telemetry/dds/support.h"
#include "tests/rt/telemetry/view/web_page.h"

namespace sandrunner {
namespace {

constexpr const char* kForward = R"({"say":"drive","vx":0.5,"vy":0,"wz":0})";
constexpr const char* kTaken = "another operator drives the robot";

DdsConfig config_with_patience() {
  DdsConfig config = test_config();
  config.stale_s = 60.0;  // a velocity holds for longer than any test takes
  return config;
}

// A robot that walks, commanded from a page and over DDS.
struct ViewAndDdsTest : testing::Test {
  ViewAndDdsTest() : peer(setup.config), asker(peer) {
    const std::string url = server.url();
    page = std::make_unique<WebPage>(std::stoi(url.substr(url.find(':', 6) + 1)));
    page->say(R"({"say":"hello","key":")" + url.substr(url.find("#key=") + 5) + "\"}");
    EXPECT_TRUE(page->hear("hello").at("key"));
    EXPECT_EQ(asked_by_page("arm"), "mode damping");
    EXPECT_EQ(asked_by_page("stand"), "mode stand_up");
    EXPECT_TRUE(wait_until([&] { return setup.robot.mode() == Mode::kStand; }));
    EXPECT_TRUE(asker.ask("walk").accepted);
    twist = peer.writer("rt/cmd_vel", geometry_msgs_msg_dds__Twist__desc);
  }
  std::string asked_by_page(const std::string& request) {
    page->say(R"({"say":"request","name":")" + request + "\"}");
    return page->hear("answer").at("text");
  }
  std::string asked_over_dds(const std::string& request) {
    const sandrunner_ModeReply reply = asker.ask(request);
    return reply.accepted ? "accepted" : reply.reason;
  }

  ViewFeed feed{RunScene{.robot = example_robot()}};
  LiveSetup setup{config_with_patience()};
  const ViewServer server{0, {.feed = feed, .desk = &setup.desk}};
  Peer peer;
  Asker asker;
  dds_entity_t twist = 0;
  std::unique_ptr<WebPage> page;
};

TEST_F(ViewAndDdsTest, WhileAPageDrivesAPublisherIsRefusedButMayStopTheRobot) {
  page->say(kForward);
  ASSERT_TRUE(wait_until([&] { return setup.robot.speed_mps() == 0.5; }));
  drive(twist, -0.5);
  ASSERT_TRUE(wait_until([&] { return setup.desk.counts().other_publisher == 1; }));
  ASSERT_TRUE(setup.robot.go_on());
  EXPECT_EQ(setup.robot.speed_mps(), 0.5);
  EXPECT_EQ(asked_over_dds("stand"), kTaken);
  EXPECT_EQ(setup.robot.mode(), Mode::kWalk);
  EXPECT_EQ(asked_over_dds("stop"), "accepted");
  ASSERT_TRUE(wait_until([&] { return setup.robot.speed_mps() == 0.0; }));
  EXPECT_EQ(asked_over_dds("damp"), "accepted");
  EXPECT_EQ(setup.robot.mode(), Mode::kDamping);
}

TEST_F(ViewAndDdsTest, WhileAPublisherDrivesAPageIsRefusedButMayStopTheRobot) {
  drive(twist, 0.5);
  ASSERT_TRUE(wait_until([&] { return setup.robot.speed_mps() == 0.5; }));
  page->say(kForward);
  EXPECT_EQ(page->hear("refused").at("why"), kTaken);
  EXPECT_EQ(setup.desk.counts().accepted, 1u);
  EXPECT_EQ(asked_by_page("stand"), kTaken);
  EXPECT_EQ(setup.robot.mode(), Mode::kWalk);
  EXPECT_EQ(asked_by_page("stop"), "mode walk");  // it slows down first
  ASSERT_TRUE(wait_until([&] { return setup.robot.speed_mps() == 0.0; }));
  EXPECT_EQ(asked_by_page("damp"), "mode damping");
  EXPECT_EQ(setup.robot.mode(), Mode::kDamping);
}

}  // namespace
}  // namespace sandrunner
