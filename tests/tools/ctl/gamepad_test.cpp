// SPDX-License-Identifier: BSD-3-Clause
#include "tools/ctl/gamepad.h"

#include <gtest/gtest.h>
#include <linux/input-event-codes.h>

namespace sandrunner::ctl {
namespace {

constexpr AxisRange kWide{.min = -32768, .max = 32767, .flat = 128};
constexpr AxisRange kByte{.min = 0, .max = 255, .flat = 0};

TEST(GamepadTest, CommandsNothingWhileTheEnableButtonIsNotHeld) {
  Gamepad pad({kWide, kWide, kWide});
  pad.event(EV_ABS, ABS_Y, -32768);
  EXPECT_FALSE(pad.command(1.0, 0));
  pad.event(EV_KEY, BTN_TR, 1);  // another button
  EXPECT_FALSE(pad.command(1.0, 0));
  pad.event(EV_KEY, BTN_TL, 1);
  EXPECT_TRUE(pad.command(1.0, 0));
  pad.event(EV_KEY, BTN_TL, 0);
  EXPECT_FALSE(pad.command(1.0, 0));
}

TEST(GamepadTest, SticksBecomeVelocities) {
  Gamepad pad({kWide, kWide, kWide});
  pad.event(EV_KEY, BTN_TL, 1);
  pad.event(EV_ABS, ABS_Y, -32768);  // up
  pad.event(EV_ABS, ABS_X, -32768);  // left
  pad.event(EV_ABS, ABS_RX, 32767);  // right
  pad.event(EV_ABS, ABS_RY, 32767);  // has no meaning
  const auto command = pad.command(0.8, 0);
  ASSERT_TRUE(command);
  EXPECT_DOUBLE_EQ(command->vx_mps, 0.8);
  EXPECT_DOUBLE_EQ(command->vy_mps, 0.4);
  EXPECT_DOUBLE_EQ(command->wz_radps, -0.8);
}

TEST(GamepadTest, RestsAtZeroAndGrowsFromTheEdgeOfTheDeadZone) {
  Gamepad pad({kByte, kByte, kByte});
  pad.event(EV_KEY, BTN_TL, 1);
  auto command = pad.command(1.0, 0);
  ASSERT_TRUE(command);
  EXPECT_EQ(command->vx_mps, 0.0);
  EXPECT_EQ(command->wz_radps, 0.0);
  pad.event(EV_ABS, ABS_Y, 116);  // 9 % of the way
  EXPECT_EQ(pad.command(1.0, 0)->vx_mps, 0.0);
  pad.event(EV_ABS, ABS_Y, 114);  // 10.6 %: of the 90 % beyond the dead zone
  EXPECT_NEAR(pad.command(1.0, 0)->vx_mps, ((127.5 - 114.0) / 127.5 - 0.1) / 0.9, 1e-9);
  pad.event(EV_ABS, ABS_Y, 0);
  EXPECT_DOUBLE_EQ(pad.command(1.0, 0)->vx_mps, 1.0);
  pad.event(EV_ABS, ABS_Y, -1000);  // beyond what the device states
  EXPECT_DOUBLE_EQ(pad.command(1.0, 0)->vx_mps, 1.0);
}

TEST(GamepadTest, AStickThatIsHeldDoesNotDriveOnWithoutEvents) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  Gamepad pad({kWide, kWide, kWide});
  pad.event(EV_KEY, BTN_TL, 1);
  pad.heard(5 * kSecond_ns);
  EXPECT_FALSE(pad.silent(60 * kSecond_ns));  // at rest: zero is what it commands
  pad.event(EV_ABS, ABS_Y, -32768);
  pad.heard(60 * kSecond_ns);
  EXPECT_EQ(pad.command(1.0, 61 * kSecond_ns)->vx_mps, 1.0);
  EXPECT_FALSE(pad.silent(61 * kSecond_ns));
  EXPECT_TRUE(pad.silent(61 * kSecond_ns + 1));
  EXPECT_EQ(pad.command(1.0, 61 * kSecond_ns + 1)->vx_mps, 0.0);
  pad.heard(62 * kSecond_ns);
  EXPECT_EQ(pad.command(1.0, 62 * kSecond_ns)->vx_mps, 1.0);
}

TEST(GamepadTest, AnAxisWithoutARangeCommandsNothing) {
  Gamepad pad({AxisRange{.min = 0, .max = 0}, kWide, kWide});
  pad.event(EV_KEY, BTN_TL, 1);
  pad.event(EV_ABS, ABS_X, 5);
  EXPECT_EQ(pad.command(1.0, 0)->vy_mps, 0.0);
}

TEST(GamepadTest, AfterAStopOrLostEventsTheButtonMustBePressedAnew) {
  for (const bool lost : {false, true}) {
    Gamepad pad({kWide, kWide, kWide});
    pad.event(EV_KEY, BTN_TL, 1);
    if (lost) {
      pad.event(EV_SYN, SYN_DROPPED, 0);
    } else {
      pad.stop();
    }
    EXPECT_FALSE(pad.command(1.0, 0));
    pad.event(EV_KEY, BTN_TL, 2);  // a held button repeats
    EXPECT_FALSE(pad.command(1.0, 0));
    pad.event(EV_KEY, BTN_TL, 0);
    pad.event(EV_KEY, BTN_TL, 1);
    EXPECT_TRUE(pad.command(1.0, 0));
  }
}

}  // namespace
}  // namespace sandrunner::ctl
