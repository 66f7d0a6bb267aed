// SPDX-License-Identifier: BSD-3-Clause
#include "rt/realtime/watchdog.h"

#include <gtest/gtest.h>

namespace sandrunner {
namespace {

constexpr std::int64_t kMs = 1'000'000;

class CutRobot final : public RobotIo {
 public:
  void read(std::uint64_t, SensorFrame&) noexcept override {}
  void write(const SafeCommand&) noexcept override {}
  void cut_drives() noexcept override { ++cuts; }
  void shut_down() noexcept override {}
  int cuts = 0;
};

class WatchdogTest : public testing::Test {
 protected:
  void look_until(std::int64_t end_ns) {
    for (; now_ns < end_ns; now_ns += 5 * kMs) watchdog.look(now_ns);
  }
  CutRobot robot;
  std::atomic<std::uint64_t> ticks{0};
  ManualClock clock;
  Watchdog watchdog{robot, ticks, clock};
  std::int64_t now_ns = 1000 * kMs;
};

TEST_F(WatchdogTest, AControlThreadThatTicksKeepsItsDrives) {
  for (int n = 0; n < 1000; ++n) {
    ++ticks;
    look_until(now_ns + 95 * kMs);
  }
  EXPECT_EQ(robot.cuts, 0);
}

TEST_F(WatchdogTest, OneThatHangsForAHundredMillisecondsLosesThemAndIsToldSoUntilItTicks) {
  look_until(now_ns + 100 * kMs);
  EXPECT_EQ(robot.cuts, 0);
  look_until(now_ns + 5 * kMs);
  EXPECT_EQ(robot.cuts, 1);
  EXPECT_TRUE(watchdog.has_cut());
  look_until(now_ns + 50 * kMs);
  EXPECT_EQ(robot.cuts, 11);
  ++ticks;
  look_until(now_ns + 95 * kMs);
  EXPECT_EQ(robot.cuts, 11);
  EXPECT_TRUE(watchdog.has_cut());
}

TEST_F(WatchdogTest, AStallOfTheWholeMachineIsNotTheControlThreads) {
  look_until(now_ns + 90 * kMs);
  now_ns += 5000 * kMs;  // the watchdog did not run either
  look_until(now_ns + 100 * kMs);
  EXPECT_EQ(robot.cuts, 0);
  look_until(now_ns + 10 * kMs);
  EXPECT_EQ(robot.cuts, 2);  // one a look
}

TEST_F(WatchdogTest, TheLongestTimeWithoutALookIsKept) {
  look_until(now_ns + 50 * kMs);
  EXPECT_EQ(watchdog.longest_gap_ns(), 5 * kMs);
  now_ns += 3000 * kMs;
  look_until(now_ns + 50 * kMs);
  EXPECT_EQ(watchdog.longest_gap_ns(), 3005 * kMs);
}

}  // namespace
}  // namespace sandrunner
