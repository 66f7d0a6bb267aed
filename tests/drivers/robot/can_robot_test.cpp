// SPDX-License-Identifier: BSD-3-Clause
// What of the robot needs no bus. With buses it runs on the bench (tools/hil).
#include "drivers/robot/can_robot.h"

#include <gtest/gtest.h>

namespace sandrunner {
namespace {

TEST(CanRobotTest, AStepOfTheWallClockMakesNoFrameOlderThanTheTimeSinceThereWasNone) {
  constexpr std::int64_t kHour_ns = 3'600'000'000'000, kLongest_ns = 250'000;
  EXPECT_EQ(frame_age_ns(1'000'000, 1'100'000, kLongest_ns), 100'000);
  EXPECT_EQ(frame_age_ns(1'000'000, 1'100'000 + kHour_ns, kLongest_ns), kLongest_ns);
  EXPECT_EQ(frame_age_ns(1'000'000, 1'100'000 - kHour_ns, kLongest_ns), 0);
}

}  // namespace
}  // namespace sandrunner
