// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/robot/dry_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/drivers/robot/example.h"

namespace sandrunner {
namespace {

using testing::HasSubstr;

JointArray<SetPoint> stand() {
  JointArray<SetPoint> points;
  points.fill({.position_rad = 0.5, .kp_nmprad = 100.0, .kd_nmsprad = 1.0});
  return points;
}

TEST(DryRunTest, FramesAreAsCandumpPrintsThem) {
  CanFrame frame{.id = 0x1A, .length = 3, .data = {0x01, 0xAB, 0xFF}};
  EXPECT_EQ(candump_line("can0", frame), "  can0  01A   [3]  01 AB FF");
  frame = {.id = 0x8001, .extended = true, .fd = true, .brs = true, .length = 3, .data = {1, 2, 3}};
  EXPECT_EQ(candump_line("vcan0", frame), "  vcan0  00008001  [03]  01 02 03");
}

TEST(DryRunTest, EveryDriveIsToldOffEnableAndThePoseInItsOwnProtocol) {
  const std::string mit = dry_run(example_hardware("mit"), example_robot(), stand());
  EXPECT_THAT(mit, HasSubstr("LF_HFE at 0.5000 rad\n"
                             "  can0  002   [8]  FF FF FF FF FF FF FF FD   off\n"
                             "  can0  002   [8]  FF FF FF FF FF FF FF FC   enable\n"
                             "  can0  002   [8]  "));
  EXPECT_THAT(mit, HasSubstr("   0.4999 rad, -0.012 rad/s, kp 100.00, kd 1.000, "));
  EXPECT_THAT(mit, HasSubstr("RH_KFE at"));

  const std::string moteus = dry_run(example_hardware("moteus"), example_robot(), stand());
  EXPECT_THAT(moteus, HasSubstr("  can0  00008001  ["));
  EXPECT_THAT(moteus,
              HasSubstr("kp 100.00, kd 1.000, 0.000 N m, at most 63.5 N m, times out after"));
}

TEST(DryRunTest, TheHostsLoopTellsNoTorqueAtTheSetPoint) {
  const std::string text =
      dry_run(example_hardware("mit", {"hardware.mode=torque"}), example_robot(), stand());
  EXPECT_THAT(text, HasSubstr("a joint at its setpoint gets none"));
  EXPECT_THAT(text, HasSubstr("kp 0.00, kd 0.000"));
}

}  // namespace
}  // namespace sandrunner
