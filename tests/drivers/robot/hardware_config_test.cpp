// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/robot/hardware_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "rt/base/errors.h"
#include "tests/drivers/robot/example.h"
#include "tests/support/error_of.h"

namespace sandrunner {
namespace {

using testing::HasSubstr;

std::string text_of(const std::string& name) {
  std::ifstream file(std::string(SANDRUNNER_HARDWARE_EXAMPLES) + "/" + name + ".toml");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// What reading says of an example in which the first `from` became `to`.
std::string refusal(const std::string& name, const std::string& from, const std::string& to,
                    const std::string& assignment = "") {
  std::string text = text_of(name);
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  ConfigTree tree;
  tree.add_text(text, "test.toml");
  if (!assignment.empty()) tree.set(assignment);
  return error_of([&] {
    read_hardware_config(tree, example_robot(), example_gate());
    tree.reject_unknown();
  });
}

TEST(HardwareConfigTest, ExamplesNameEveryJointOnce) {
  for (const char* name : {"mit", "moteus"}) {
    const HardwareConfig config = example_hardware(name);
    EXPECT_EQ(config.buses.size(), 4u);
    for (int j = 0; j < kNumJoints; ++j) {
      EXPECT_EQ(config.drives[j].bus, j / 3);
      EXPECT_EQ(config.drives[j].id(), j % 3 + 1);
    }
  }
  EXPECT_EQ(example_hardware("moteus").ticks_per_exchange(), 4);
  EXPECT_EQ(example_hardware("mit").ticks_per_exchange(), 5);
}

TEST(HardwareConfigTest, NoExampleConfirmsWhatTheUserHasToVerify) {
  for (const char* name : {"mit", "damiao", "moteus"}) {
    EXPECT_FALSE(example_hardware(name).timeout_unverified) << name;
  }
}

TEST(HardwareConfigTest, XsensImuHasItsOwnUsualRate) {
  EXPECT_EQ(example_hardware("mit").imu.protocol, ImuProtocol::kMip);
  ConfigTree tree;
  std::string text = text_of("mit");
  const auto replace = [&text](const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
  };
  replace("\"mip\"", "\"xsens\"");
  replace("rate_hz = 500", "");
  tree.add_text(text, "test.toml");
  const ImuConfig imu = read_hardware_config(tree, example_robot(), example_gate()).imu;
  EXPECT_EQ(imu.protocol, ImuProtocol::kXsens);
  EXPECT_EQ(imu.rate_hz, 400);
  EXPECT_EQ(imu.quaternion_rate_hz, 400);
}

TEST(HardwareConfigTest, ADriveThatHoldsATorqueLetsGoWithin50Ms) {
  EXPECT_EQ(example_hardware("mit", {"hardware.drive_timeout_s=0.1"}).drive_timeout_s, 0.1);
  EXPECT_THROW(example_hardware("mit", {"hardware.mode=torque", "hardware.drive_timeout_s=0.051"}),
               InputError);
  EXPECT_NO_THROW(
      example_hardware("mit", {"hardware.mode=torque", "hardware.drive_timeout_s=0.05"}));
}

TEST(HardwareConfigTest, RefusesWhatCannotWork) {
  EXPECT_THAT(refusal("mit", "\"LF_HFE\"", "\"LF_HAA\""), HasSubstr("LF_HAA stands twice"));
  EXPECT_THAT(refusal("mit", "\"LF_HFE\"", "\"LF_TOE\""), HasSubstr("'LF_TOE', expected one of"));
  EXPECT_THAT(refusal("mit", "id = 2", "id = 1"), HasSubstr("id 1 on can0 is that of LF_HAA"));
  EXPECT_THAT(refusal("mit", "\"mit\"", "\"canopen\""), HasSubstr("canopen"));
  EXPECT_THAT(refusal("mit", "protocol = \"mit\"", ""), HasSubstr("found no protocol"));
  EXPECT_THAT(refusal("mit", "model = \"AK10-9\"", ""), HasSubstr("expected one of AK80-6 V1.0"));
  EXPECT_THAT(refusal("mit", "\"AK10-9\"", "\"AK80-9 V2\""),
              HasSubstr("torque up to 63.45 N m needed, 18"));
  EXPECT_THAT(refusal("mit", "bus = \"can0\"", "bus = \"can9\""), HasSubstr("bus 'can9' is none"));
  EXPECT_THAT(refusal("mit", "\"can1\"", "\"can0\""), HasSubstr("'can0' stands twice"));
  EXPECT_THAT(refusal("mit", "sign = 1", "sign = 0"), HasSubstr("sign 0"));
  EXPECT_THAT(refusal("mit", "sign = 1", "sign = 2"), HasSubstr("hardware.drive[0].sign"));
  EXPECT_THAT(refusal("mit", "sign = 1", "position_rad = 2.0"),
              HasSubstr("rad from its zero needed"));
  EXPECT_THAT(refusal("mit", "rate_hz = 800", "rate_hz = 900"), HasSubstr("a divisor of 4000"));
  EXPECT_THAT(refusal("mit", "baud = 921600", "baud = 115200"), HasSubstr("115200"));
  EXPECT_THAT(refusal("mit", "device = \"/dev/ttyS1\"", ""), HasSubstr("hardware.imu.device"));
  EXPECT_THAT(
      refusal("mit", "\"mip\"", "\"vectornav\""),
      HasSubstr("hardware.imu.protocol: found \"vectornav\", expected one of \"mip\", \"xsens\""));
  EXPECT_THAT(refusal("mit", "rate_hz = 800", "rate = 800"), HasSubstr("rate"));
  EXPECT_THAT(refusal("moteus", "kp_nmprev = 1300.0", ""), HasSubstr("found no kp_nmprev"));
  EXPECT_THAT(refusal("moteus", "kp_nmprev = 1300.0", "kp_nmprev = 600.0"),
              HasSubstr("kp up to 200 N m/rad needed, 95.49"));
  EXPECT_THAT(refusal("moteus", "max_torque_nm = 65.0", ""), HasSubstr("found no max_torque_nm"));
  EXPECT_THAT(refusal("moteus", "sign = 1", "gear = 9.0"), HasSubstr("speed up to 25.7 rad/s"));
  EXPECT_THAT(
      refusal("mit", "[hardware]\n", "[hardware]\nvoltage_low_v = 50.0\nvoltage_high_v = 40.0\n"),
      HasSubstr("50 is above hardware.voltage_high_v, 40"));
}

TEST(HardwareConfigTest, RefusesADriveThatItsBusCannotCarry) {
  EXPECT_THAT(refusal("moteus", "protocol = \"moteus\"", "protocol = \"moteus\"\nfd = false"),
              HasSubstr("hardware.bus[0] (can0): moteus drives speak CAN FD alone"));
  EXPECT_THAT(refusal("mit", "protocol = \"mit\"", "protocol = \"mit\"\nfd = true"),
              HasSubstr("LF_HAA: AK10-9 speaks classic CAN alone"));
}

TEST(HardwareConfigTest, RefusesIdsThatAReplyCannotTellApart) {
  EXPECT_THAT(refusal("mit", "id = 2\nmodel = \"AK10-9\"", "id = 16\nmodel = \"DM8009\""),
              HasSubstr("LF_HFE: id 16, but a Damiao names only 1 to 15"));
  EXPECT_THAT(refusal("mit", "reply_id = 0", "reply_id = 2"),
              HasSubstr("LF_HAA: reply_id 2 on can0 is the id of LF_HFE"));
}

TEST(HardwareConfigTest, AJointWithoutADriveIsNamed) {
  std::string text = text_of("mit");
  text.resize(text.rfind("[[hardware.drive]]"));
  ConfigTree tree;
  tree.add_text(text, "test.toml");
  EXPECT_THAT(error_of([&] { read_hardware_config(tree, example_robot(), example_gate()); }),
              HasSubstr("found none of joint RH_KFE"));
}

TEST(HardwareConfigTest, AgesOfTheGateFollowTheRateOfTheExchange) {
  GateConfig gate = example_gate();
  fit_gate_to(example_hardware("moteus", {"hardware.rate_hz=500", "hardware.torque_scale=0.5"}),
              gate);
  EXPECT_EQ(gate.joints_limit_ticks, 10u);
  EXPECT_EQ(gate.joints_fault_ticks, 24u);
  EXPECT_DOUBLE_EQ(gate.torque_limit_nm[3], 0.5 * 63.45);
  EXPECT_FALSE(gate.hanging);
}

TEST(HardwareConfigTest, WhatGuardsNothingIsNamed) {
  EXPECT_EQ(unguarded(HardwareConfig{}).size(), 2u);
  HardwareConfig config;
  config.emergency_stop = {.chip = "/dev/gpiochip0", .line = 3};
  config.voltage_low_v = 40.0;
  EXPECT_TRUE(unguarded(config).empty());
}

TEST(HardwareConfigTest, ASpeedThatIsAFaultIsOneThatRepliesCanTell) {
  for (const auto& [name, fastest_radps] : {std::pair{"mit", 50.0}, {"moteus", 51.47}}) {
    GateConfig gate = example_gate();
    gate.speed_fault_radps = {60.0, 60.0, 30.0};
    fit_gate_to(example_hardware(name), gate);
    EXPECT_NEAR(gate.speed_fault_radps[1], 0.98 * fastest_radps, 0.01) << name;
    EXPECT_EQ(gate.speed_fault_radps[2], 30.0) << name;
  }
}

TEST(HardwareConfigTest, TheSlowestRatesStayBelowTheGatesCeilings) {
  GateConfig gate = example_gate();
  fit_gate_to(example_hardware("moteus", {"hardware.rate_hz=400", "hardware.imu.rate_hz=100",
                                          "hardware.imu.quaternion_rate_hz=100"}),
              gate);
  EXPECT_EQ(gate.joints_fault_ticks, 30u);
  EXPECT_EQ(gate.imu_limit_ticks, 44u);
  EXPECT_EQ(gate.imu_late_ticks, 120u);
  EXPECT_EQ(gate.imu_attitude_samples, 1u);
  EXPECT_EQ(gate.imu_fault_ticks, 160u);
  const GateConfig bounded = below_ceilings(gate);
  EXPECT_EQ(bounded.joints_fault_ticks, gate.joints_fault_ticks);
  EXPECT_EQ(bounded.imu_fault_ticks, gate.imu_fault_ticks);
}

TEST(HardwareConfigTest, AnAttitudeThatIsSentLessOftenMayRepeat) {
  GateConfig gate = example_gate();
  fit_gate_to(example_hardware(
                  "moteus", {"hardware.imu.rate_hz=1000", "hardware.imu.quaternion_rate_hz=100"}),
              gate);
  EXPECT_EQ(gate.imu_attitude_samples, 10u);
}

TEST(HardwareConfigTest, EveryTorqueCommandOfAScaledRobotFitsASmallerDrive) {
  const char* const own = "max_torque_nm = 65.0";
  const char* const smaller = "max_torque_nm = 13.0";
  EXPECT_THAT(refusal("moteus", own, smaller), HasSubstr("torque up to 63.45 N m needed, 13"));
  EXPECT_EQ(refusal("moteus", own, smaller, "hardware.torque_scale=0.2"), "");
}

}  // namespace
}  // namespace sandrunner
