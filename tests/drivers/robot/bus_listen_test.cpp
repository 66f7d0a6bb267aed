// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/robot/bus_listen.h"

#include <gtest/gtest.h>

#include "tests/drivers/robot/example.h"

namespace sandrunner {
namespace {

TEST(BusListenTest, ASilentBusIsNoProblem) {
  const HardwareConfig config = example_hardware("mit");
  std::vector<BusTraffic> traffic(config.buses.size());
  CanFrame error;
  error.error = true;
  traffic[0].add(config, 0, error);  // a report of the interface itself
  EXPECT_TRUE(traffic_problems(config, example_robot(), traffic).empty());
}

TEST(BusListenTest, CommandsAndRepliesAreCountedAndTheirJointsNamed) {
  const HardwareConfig config = example_hardware("mit");
  std::vector<BusTraffic> traffic(config.buses.size());
  const MitDrive& drive = mit_of(config.drives[4]);
  CanFrame frame;
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(encode_mit_command(drive, {}, frame), MitStatus::kOk);
    traffic[1].add(config, 1, frame);
  }
  MitReply reply;
  reply.temperature_degc = 30.0;
  ASSERT_EQ(encode_mit_reply(drive, reply, frame), MitStatus::kOk);
  traffic[1].add(config, 1, frame);
  const std::vector<std::string> problems = traffic_problems(config, example_robot(), traffic);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0],
            "hardware.bus can1: found 4 frames in 0.2 s (3 commands to and 1 replies of RF_HFE), "
            "expected a silent bus: another program uses it; stop that first. Nothing was sent");
}

TEST(BusListenTest, FramesOfUnknownDrivesCountAsWell) {
  const HardwareConfig config = example_hardware("moteus");
  std::vector<BusTraffic> traffic(config.buses.size());
  CanFrame frame;
  frame.id = 0x123;
  traffic[2].add(config, 2, frame);
  const std::vector<std::string> problems = traffic_problems(config, example_robot(), traffic);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0],
            "hardware.bus can2: found 1 frames in 0.2 s (none of them of a configured drive), "
            "expected a silent bus: another program uses it; stop that first. Nothing was sent");
}

}  // namespace
}  // namespace sandrunner
