// SPDX-License-Identifier: BSD-3-Clause
// The robot and a peer that is built on another DDS, over the wire.
#include <gtest/gtest.h>

#include <sstream>

#include "rt/telemetry/dds/ros_node.h"
#include "tests/rt/telemetry/dds/support.h"
#include "tests/rt/telemetry/example_tick.h"
#include "tests/support/child_process.h"

namespace sandrunner {
namespace {

TEST(FastDdsTest, ReceivesEveryRosTopicWithTheRightValuesAndDrivesTheRobot) {
  LiveSetup setup;
  Telemetry telemetry(setup.participant, setup.config, example_robot(), &setup.desk,
                      RunClock::kRealtime);
  telemetry.begin(kExampleStart_ns);
  {
    Peer peer(setup.config);
    Asker asker(peer);
    ASSERT_TRUE(asker.ask("arm").accepted);
    ASSERT_TRUE(asker.ask("stand").accepted);
    ASSERT_TRUE(wait_until([&] { return setup.robot.mode() == Mode::kStand; }));
    ASSERT_TRUE(asker.ask("walk").accepted);
  }
  ChildProcess fast(
      {SANDRUNNER_FASTDDS_PEER, std::to_string(setup.config.domain), "0.7", "4", "loopback"});
  double fastest_mps = 0.0;
  const auto start = std::chrono::steady_clock::now();
  for (std::uint64_t tick = 0; tick < 4 * kControlHz;) {
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
    for (; tick < ticks_from_s(time.count()); ++tick) telemetry.add(example_tick(tick));
    fastest_mps = std::max(fastest_mps, setup.robot.speed_mps());
    sleep_s(0.002);
  }
  const double sent = number_after(fast.wait().out, "sent");
  EXPECT_GT(sent, 50.0);
  EXPECT_GE(static_cast<double>(setup.desk.counts().accepted), 0.9 * sent);
  EXPECT_EQ(fastest_mps, 0.7);

  const std::string text = fast.wait().out;
  SCOPED_TRACE(text);
  for (const char* topic : {"joint_states", "imu", "odom", "tf"}) {
    EXPECT_GE(number_after(text, std::string("\n") + topic), 150.0) << topic;
    EXPECT_LE(number_after(text, std::string("\n") + topic), 400.0) << topic;
  }
  EXPECT_GE(number_after(text, "\ndiagnostics"), 1.0);
  EXPECT_EQ(number_after(text, "\nrobot_description"), 1.0);

  const auto has = [&](const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << part;
  };
  has(example_robot().ros_urdf);
  // The stamp says which tick it is; the last joint's position says the same.
  const auto at = text.find("joint_states ");
  int count = 0;
  double stamp_s = 0.0;
  ASSERT_EQ(std::sscanf(text.c_str() + at, "joint_states %d stamp %lf", &count, &stamp_s), 2);
  const double tick = (stamp_s - 1'700'000'000.9) * kControlHz;
  std::ostringstream joints;
  joints << "frame base_link names 12";
  for (int j = 0; j < kNumJoints; ++j) {
    char values[100];
    std::snprintf(values, sizeof values, " %s %.6f %d.000000 %d.000000",
                  example_robot().joint_names[j].c_str(), 0.1 * j + 1e-6 * std::round(tick), 1 + j,
                  -2 - j);
    joints << values;
  }
  has(joints.str());
  has(" wxyz 0.707107 0.000000 0.000000 0.707107 gyro 0.100 0.200 0.300 acc 0.400 0.500 9.800\n");
  has(" frames odom base_link y ");
  has(" z 0.450 vx 0.800 yaw_variance 0.0000");
  has(" odom base_link y ");
  has(" w 0.707107 trunk FL_hip_link y 0.100000 ");
  has("\ntf_static 1 base_link trunk FL_thigh_link FL_foot\n");
  has(" sandrunner level 0 message walk mode=walk faults=none ");
}

TEST(FastDdsTest, ACallInTheBytesOfRmwCycloneddsIsAnsweredAndTheNodeIsListed) {
  LiveSetup setup;
  announce_node(setup.participant, "sandrunner");
  const auto call = [&](const char* request) {
    ChildProcess fast({SANDRUNNER_FASTDDS_PEER, std::to_string(setup.config.domain), "call",
                       request, "loopback"});
    return fast.wait().out;
  };
  const std::string refused = call("walk");
  EXPECT_EQ(refused.rfind("client 123456789abcdef number 7 success 0 message the robot "
                          "does not stand, stand comes first\nnode /sandrunner readers ",
                          0),
            0u)
      << refused;
  EXPECT_EQ(setup.robot.mode(), Mode::kPassive);
  const std::string accepted = call("arm");
  const std::string head = "client 123456789abcdef number 7 success ";
  // Where the first answer came before the robot knew who hears it, the peer asks again.
  EXPECT_TRUE(accepted.starts_with(head + "1 message mode damping\n") ||
              accepted.starts_with(head + "0 message the drives are on already\n"))
      << accepted;
  EXPECT_EQ(setup.robot.mode(), Mode::kDamping);
}

TEST(FastDdsTest, RmwFastrtpsUnderRos2LocalhostFindsTheRobotThroughItsDefaultInterface) {
  const DdsConfig config = test_config();
  const TakenPorts others(config.domain, 40);  // the robot has an index behind them
  LiveSetup setup(config);
  Telemetry telemetry(setup.participant, setup.config, example_robot(), &setup.desk,
                      RunClock::kRealtime);
  // By now the robot has announced itself twice, and does so again in 8 s only.
  sleep_s(0.3);
  ChildProcess fast({"bash", "-c",
                     "source " SANDRUNNER_ROS2_LOCALHOST " && exec " SANDRUNNER_FASTDDS_PEER " " +
                         std::to_string(setup.config.domain) + " 0.1 4 profile"});
  publish_for(telemetry, 0, 4.0);
  const std::string text = fast.wait().out;
  EXPECT_GE(number_after(text, "\nodom"), 100.0) << text.substr(0, 200);
  EXPECT_GE(setup.desk.counts().accepted, 25u);
}

}  // namespace
}  // namespace sandrunner
