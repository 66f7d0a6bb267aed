// SPDX-License-Identifier: BSD-3-Clause
// A robot's hardware file on the command line: what cannot work is one line and exit code 2, before
// anything is opened; what can be judged without the robot is judged.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <chrono>
#include <thread>

#include "drivers/can_driver.h"
#include "drivers/unitree/unitree_driver.h"
#include "rt/base/config_tree.h"
#include "rt/run/process_config.h"
#include "sim/ground/terrain_description.h"
#include "tests/rt/dds/own_domain.h"
#include "tests/support/program_test.h"

namespace sandrunner {
namespace {

using testing::HasSubstr;

class HardwareTest : public ProgramTest {
 protected:
  HardwareTest() : ProgramTest(SANDRUNNER_PROGRAM) {}

  /// Writes hardware.toml: the example mit.toml, in which the first `from` became `to`.
  void write_changed(const std::string& from, const std::string& to) {
    std::string text = read_file(SANDRUNNER_HARDWARE_EXAMPLES "/mit.toml");
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    write_file(folder_.path("hardware.toml"), text);
  }
};

struct Refusal {
  const char *from, *to;
  const char* cause;
};

constexpr Refusal kRefusals[] = {
    {"rate_hz = 800", "rate_hz = 1000", "hardware.bus can0: 3 drives at 1000 Hz"},
    {"id = 2", "", "hardware.drive of LF_HFE: found no id"},
    {"mode = ", "mood = ", "hardware.mood"},
    {"mode = ", "emergency_stop.chip = \"/dev/nosuch\"\nmode = ",
     "hardware.emergency_stop.line: found none"},
    {"mode = ", "emergency_stop = {chip = \"/dev/nosuch\", line = 3}\nmode = ",
     "hardware.emergency_stop: /dev/nosuch line 3: the chip cannot be opened"},
    {"[hardware]", "[controller.gate]\nspeed_fault_radps = 55\n[hardware]",
     "speed_fault_radps: 55 rad/s is more than the drives' replies can report"},
    {"drive_timeout_s = 0.05", "drive_timeout_s = 0.03",
     "0.03, expected more than the 0.03125 s that the loop may miss and an exchange takes"},
    {"drive_timeout_s = 0.05", "drive_timeout_s = 0.031", "0.031, expected more"},
    {"[hardware]", "[controller.gate]\nstall_fault_ticks = 400\n[hardware]",
     "0.05, expected more than the 0.10125 s that the loop may miss"},
};

TEST_F(HardwareTest, WhatCannotWorkIsRefusedBeforeAnyFrameIsSent) {
  for (const Refusal& refusal : kRefusals) {
    write_changed(refusal.from, refusal.to);
    expect_refused("--hardware hardware.toml --arm", refusal.cause);
  }
  write_file(folder_.path("hardware.toml"), "controller.stand.kp_nmprad = 90.0\n");
  expect_refused("--hardware hardware.toml --arm", "hardware.toml: found no table [hardware]");
  expect_refused("check hardware.toml", "hardware.toml: found no table [hardware]");
}

TEST_F(HardwareTest, ARobotOfAnotherKindHasItsOwnKeys) {
  const auto expect = [&](const std::string& text, const std::string& cause) {
    write_file(folder_.path("hardware.toml"), text);
    expect_refused("--hardware hardware.toml --arm", cause);
  };
  expect("hardware.kind = \"go2\"\n", "hardware.kind");
  expect("hardware.kind = \"unitree\"\n", "hardware.unitree.interface: found none, expected the");
  expect("[hardware]\nkind = \"unitree\"\nrate_hz = 500\nunitree.interface = \"lo\"\n",
         "hardware.rate_hz");
  write_changed("[hardware]", "[hardware]\nunitree.interface = \"lo\"");
  expect_refused("--hardware hardware.toml --arm", "hardware.unitree.interface");
}

TEST_F(HardwareTest, ARobotOfAnotherKindHasADryRunToo) {
  write_file(folder_.path("hardware.toml"), read_file(SANDRUNNER_UNITREE_EXAMPLE));
  ASSERT_EQ(run("--hardware hardware.toml --dry-run"), 0) << error();
  EXPECT_THAT(output(), HasSubstr("rt/lowcmd on eth0, domain 0, 500 times a second\n"));
  EXPECT_THAT(output(), HasSubstr("motor_cmd[ 4]  FL_thigh_joint q   0.7500\n"));
}

TEST_F(HardwareTest, CheckOfARobotOfAnotherKindHasNoOptions) {
  write_file(folder_.path("hardware.toml"), read_file(SANDRUNNER_UNITREE_EXAMPLE));
  for (const char* const option : {"--plan", "--move", "--nudge", "--zero lying"}) {
    expect_refused(std::string("check hardware.toml ") + option,
                   "found hardware.kind \"unitree\", expected \"can\" with --plan");
  }
  expect_refused("check hardware.toml --set hardware.unitree.interface=nosuch0",
                 "DDS: domain 0 on interface nosuch0");
}

TEST_F(HardwareTest, AStartThatWaitsForARobotEndsAtOnce) {
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    ChildProcess controller({SANDRUNNER_PROGRAM, "--hardware", SANDRUNNER_UNITREE_EXAMPLE, "--set",
                             "hardware.unitree.interface=lo", "--set",
                             fmt::format("hardware.unitree.domain={}", own_domain()), "--policy",
                             "none", "--duration", "1", "--arm"});
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    const auto begin = std::chrono::steady_clock::now();
    controller.signal(number);
    EXPECT_EQ(controller.wait().code, 128 + number);
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1));
  }
}

TEST_F(HardwareTest, TheGateWaitsForStatesThatCome500TimesASecond) {
  ConfigTree tree;
  sim::add_terrain_layer(tree, "dry-sand");
  tree.add_file(SANDRUNNER_UNITREE_EXAMPLE);
  tree.set("hardware.torque_scale=0.5");
  tree.set("hardware.hanging=true");
  const ProcessConfig config = read_process_config(tree, nullptr);
  EXPECT_NE(dynamic_cast<const UnitreeDriver*>(config.driver.get()), nullptr);
  EXPECT_EQ(config.controller.gate.joints_fault_ticks, 40);
  EXPECT_EQ(config.controller.gate.imu_fault_ticks, 120);
  EXPECT_TRUE(config.controller.gate.hanging);
  EXPECT_DOUBLE_EQ(config.controller.gate.torque_limit_nm[0], 0.5 * 23.7);
}

TEST_F(HardwareTest, ARobotDoesNotMoveByItselfUnlessArmed) {
  write_changed("", "");
  expect_refused("--hardware hardware.toml", "First look: sandrunner check hardware.toml");
  expect_refused("--hardware absent.toml",
                 "absent.toml: cannot be read (No such file or directory)");
  expect_refused("--arm", "--arm: expected --hardware");
  expect_refused("--dry-run", "--dry-run: expected --hardware");
}

TEST_F(HardwareTest, DryRunPrintsFramesAndOpensNothing) {
  write_changed("", "");
  ASSERT_EQ(run("--hardware hardware.toml --dry-run"), 0) << error();
  // The standing pose and its gains, of the robot that ships.
  EXPECT_THAT(output(), HasSubstr("LF_HFE at 0.5598 rad\n"
                                  "  can0  002   [8]  FF FF FF FF FF FF FF FD   off\n"));
  EXPECT_THAT(output(), HasSubstr("kp 100.00, kd 1.000"));
}

TEST_F(HardwareTest, CheckPlanIsATableAndFailsForAnOverloadedBus) {
  write_changed("", "");
  EXPECT_EQ(run("check --plan hardware.toml"), 0) << error();
  EXPECT_THAT(output(), HasSubstr("can3               3    53 %   65 %"));
  EXPECT_EQ(run("check hardware.toml --plan --set hardware.rate_hz=1000"), 1) << error();
  EXPECT_THAT(output(), HasSubstr("OVERLOADED"));
}

TEST_F(HardwareTest, CheckReportsAllThatIsMissingAtOnce) {
  write_changed("\"can0\"", "\"nosuch0\"");
  EXPECT_EQ(run("check hardware.toml --set hardware.imu.device=/dev/nosuch </dev/null"), 2);
  EXPECT_THAT(error(), HasSubstr("bus 'can0' is none"));  // of a drive
  write_changed("", "");
  EXPECT_EQ(run("check hardware.toml --set hardware.imu.device=/dev/nosuch </dev/null"), 1)
      << error();
  EXPECT_THAT(output(), HasSubstr("5 things are wrong; nothing was powered\n"));
  EXPECT_THAT(output(), HasSubstr("\n  CAN interface can3: "));
  EXPECT_THAT(output(), HasSubstr("/dev/nosuch"));
}

TEST_F(HardwareTest, CheckRefusesWhatDoesNotGoTogether) {
  write_changed("", "");
  expect_refused("check", "FILE");
  expect_refused("check nosuch.toml", "nosuch.toml");
  expect_refused("check hardware.toml --plan --move", "--move");
  expect_refused("check hardware.toml --plan --nudge", "--nudge");
  expect_refused("check hardware.toml --nudge", "hardware.hanging is false, expected true");
  expect_refused("check hardware.toml --zero standing", "standing");
  expect_refused("check hardware.toml --arm", "expected no --hardware, --arm or --dry-run");
}

const HardwareConfig& hardware_of(const ProcessConfig& config) {
  return dynamic_cast<const CanDriver&>(*config.driver).config();
}

HardwareConfig settings_of(const std::string& example,
                           const std::vector<std::string>& assignments) {
  ConfigTree tree;
  sim::add_terrain_layer(tree, "dry-sand");
  tree.add_file(std::string(SANDRUNNER_HARDWARE_EXAMPLES) + "/" + example);
  for (const std::string& assignment : assignments) tree.set(assignment);
  return hardware_of(read_process_config(tree, nullptr));
}

TEST_F(HardwareTest, ADriveMayLetGoSoonWhereTheLoopMayMissLittle) {
  EXPECT_EQ(settings_of("mit.toml",
                        {"hardware.drive_timeout_s=0.02", "controller.gate.stall_fault_ticks=40"})
                .drive_timeout_s,
            0.02);
}

TEST_F(HardwareTest, ALowerTorqueLimitOfTheGateIsTheDrivesToo) {
  const HardwareConfig h = settings_of(
      "moteus.toml", {"controller.gate.torque_limit_nm=20", "hardware.torque_scale=0.5"});
  for (const DriveConfig& drive : h.drives) EXPECT_DOUBLE_EQ(drive.max_torque_nm, 20.0);
  for (const DriveConfig& drive : settings_of("moteus.toml", {}).drives) {
    EXPECT_DOUBLE_EQ(drive.max_torque_nm, 63.45);
  }
}

TEST_F(HardwareTest, EffectiveSettingsReadBackToTheSame) {
  for (const char* example : {"mit.toml", "moteus.toml"}) {
    ConfigTree tree;
    sim::add_terrain_layer(tree, "dry-sand");
    tree.add_file(std::string(SANDRUNNER_HARDWARE_EXAMPLES) + "/" + example);
    tree.set("hardware.torque_scale=0.3");
    const ProcessConfig first = read_process_config(tree, nullptr);
    ConfigTree again;
    again.add_text(first.effective, "config.toml");
    const ProcessConfig second = read_process_config(again, nullptr);
    EXPECT_EQ(second.effective, first.effective);
    EXPECT_THAT(first.effective, HasSubstr("\nhardware.drive = [\n  {bus = \"can0\""));
    for (int j = 0; j < kNumJoints; ++j) {
      EXPECT_EQ(hardware_of(second).drives[j].id(), hardware_of(first).drives[j].id());
      EXPECT_EQ(second.controller.gate.torque_limit_nm[j],
                first.controller.gate.torque_limit_nm[j]);
    }
  }
}

}  // namespace
}  // namespace sandrunner
