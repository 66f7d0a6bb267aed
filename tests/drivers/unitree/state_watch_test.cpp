// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/unitree/state_watch.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sandrunner::unitree {
namespace {

constexpr std::int64_t kMillisecond_ns = 1'000'000;

LowState state_of(std::uint32_t tick_ms) {
  RobotState robot;
  robot.tick_ms = tick_ms;
  LowState message;
  encode_state(robot, message);
  return message;
}

TEST(StateWatchTest, AStateIsNewWhenItsClockHasAdvanced) {
  StateWatch watch(1000);
  EXPECT_TRUE(watch.take(state_of(100), 0));
  EXPECT_TRUE(watch.take(state_of(102), 2 * kMillisecond_ns));
  EXPECT_FALSE(watch.take(state_of(102), 4 * kMillisecond_ns));
  EXPECT_FALSE(watch.take(state_of(98), 6 * kMillisecond_ns));
  EXPECT_TRUE(watch.take(state_of(108), 8 * kMillisecond_ns));
  EXPECT_EQ(watch.counters().taken, 3);
  EXPECT_EQ(watch.counters().repeated, 1);
  EXPECT_EQ(watch.counters().old, 1);
  EXPECT_EQ(watch.counters().received(), 5);
}

TEST(StateWatchTest, TheClockOfTheRobotMayWrap) {
  StateWatch watch(1000);
  EXPECT_TRUE(watch.take(state_of(0xFFFFFFFF), 0));
  EXPECT_TRUE(watch.take(state_of(1), 2 * kMillisecond_ns));
  EXPECT_EQ(watch.sampled_ns(), 2 * kMillisecond_ns);
}

TEST(StateWatchTest, AWrongCrcIsNoStateAndAnAbsentOneIs) {
  StateWatch watch(1000);
  LowState message = state_of(100);
  message.crc = 1;
  EXPECT_FALSE(watch.take(message, 0));
  message.crc = 0;
  EXPECT_TRUE(watch.take(message, 2 * kMillisecond_ns));
  EXPECT_EQ(watch.counters().bad_crc, 1);
  EXPECT_EQ(watch.counters().without_crc, 1);
}

TEST(StateWatchTest, ANumberThatIsNotFiniteIsNoStateAndKeepsTheOneBefore) {
  StateWatch watch(1000);
  ASSERT_TRUE(watch.take(state_of(100), 0));
  LowState message = state_of(102);
  message.motor_state[0].q = NAN;
  message.crc = crc_of(message);
  EXPECT_FALSE(watch.take(message, 2 * kMillisecond_ns));
  EXPECT_EQ(watch.counters().not_finite, 1);
  EXPECT_EQ(watch.state().tick_ms, 100);
}

TEST(StateWatchTest, AStateThatComesLateIsAsOldAsTheRobotsClockSays) {
  StateWatch watch(1000);
  for (std::uint32_t i = 0; i < 100; ++i) watch.take(state_of(2 * i), 2 * i * kMillisecond_ns);
  // Held up for 30 ms, then all at once.
  for (std::uint32_t i = 100; i < 115; ++i) {
    ASSERT_TRUE(watch.take(state_of(2 * i), 230 * kMillisecond_ns));
    EXPECT_NEAR(static_cast<double>(watch.sampled_ns()), 2.0 * i * kMillisecond_ns,
                0.1 * kMillisecond_ns);
  }
}

TEST(StateWatchTest, FiguresAreOfTheStatesSinceTheirBeginning) {
  StateWatch watch(1000);
  watch.take(state_of(0), 0);
  watch.take(state_of(100), 100 * kMillisecond_ns);
  watch.begin_figures();
  EXPECT_EQ(watch.rate_hz(), 0.0);
  for (std::uint32_t i = 0; i <= 250; ++i) {
    if (i == 20 || i == 21) continue;  // lost
    watch.take(state_of(200 + 2 * i), 200 * kMillisecond_ns + 2 * i * kMillisecond_ns);
  }
  EXPECT_NEAR(watch.rate_hz(), 496.0, 0.1);
  EXPECT_NEAR(watch.longest_gap_s(), 0.006, 1e-9);
  EXPECT_NEAR(watch.tick_rate_hz(), 1000.0, 1e-6);
}

}  // namespace
}  // namespace sandrunner::unitree
