// SPDX-License-Identifier: BSD-3-Clause
// The wire's process with a robot whose DDS is not ours (fastdds_peer.cpp).
#include <gtest/gtest.h>
#include <signal.h>

#include <string>

#include "drivers/unitree/wire_process.h"
#include "rt/base/clock_ns.h"
#include "tests/rt/dds/own_domain.h"
#include "tests/support/child_process.h"
#include "tests/support/joint_names.h"

namespace sandrunner::unitree {
namespace {

RobotFigures robot_of_test() {
  RobotFigures robot;
  for (int j = 0; j < kNumJoints; ++j) robot.joint_names[j] = kJointNames[j];
  robot.lower_rad.fill(-3.0);
  robot.upper_rad.fill(3.0);
  robot.damping_kd_nmsprad.fill(2.0);
  return robot;
}

TEST(UnitreeFastDdsTest, ARobotOnAnotherDdsIsReleasedReadAndCommanded) {
  UnitreeConfig config;
  config.interface = "lo";
  config.domain = own_domain();
  ChildProcess robot({SANDRUNNER_FASTDDS_PEER, std::to_string(config.domain)});
  RobotState state;
  StateCounters counters;
  {
    WireProcess wire(config, robot_of_test());
    wire.connect();  // throws unless states, remote, service and a reader of commands are there
    WireCommand command;
    command.enabled = 1;
    command.joints.position_rad[2] = -1.8;
    command.joints.kp_nmprad.fill(20.0);
    command.joints.kd_nmsprad.fill(0.5);
    for (int i = 0; i < 1000; ++i) {
      command.written_ns = clock_ns(CLOCK_MONOTONIC);
      wire.memory().command.write(command);
      usleep(1000);
    }
    const WireReport& report = wire.memory().report.read();
    state = report.state;
    counters = report.counters;
    EXPECT_FALSE(wire.memory().foreign);
    EXPECT_EQ(wire.memory().not_sent, 0u);
  }
  robot.signal(SIGTERM);
  const Ended ended = robot.wait();
  SCOPED_TRACE(ended);

  EXPECT_GT(counters.taken, 300u);
  EXPECT_EQ(counters.bad_crc, 0u);
  EXPECT_EQ(counters.without_crc, 0u);
  EXPECT_EQ(counters.not_finite, 0u);
  for (int j = 0; j < kNumJoints; ++j) {
    EXPECT_EQ(state.position_rad[j], 0.015625 * motor_of(j));
    EXPECT_EQ(state.temperature_degc[j], 35);
  }
  EXPECT_EQ(state.battery_percent, 80);
  EXPECT_EQ(state.supply_v, 29.0);
  EXPECT_EQ(state.linear_acceleration_mps2[2], static_cast<double>(9.81F));
  EXPECT_TRUE(state.remote.on);

  int right = 0, wrong = -1, releases = 0;
  ASSERT_EQ(
      std::sscanf(ended.out.c_str(), "right %d wrong %d releases %d", &right, &wrong, &releases),
      3);
  EXPECT_GT(right, 300);
  EXPECT_EQ(wrong, 0);
  EXPECT_GE(releases, 1);
  EXPECT_NE(ended.out.find("\nhead FEEF mode 1 q -1.8000 kp 20.00 kd 0.50\n"), std::string::npos);
}

}  // namespace
}  // namespace sandrunner::unitree
