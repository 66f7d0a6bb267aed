// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/check/check_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/drivers/robot/example.h"

namespace sandrunner {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// A robot on which all is as configured.
CheckFindings good_findings() {
  CheckFindings f;
  f.scanned.resize(4);
  for (auto& bus : f.scanned) {
    for (int id = 1; id <= 3; ++id) bus.push_back({.id = id, .reply_id = 0});
  }
  for (FoundDrive& drive : f.drives) {
    drive = {.requests = 200,
             .replies = 200,
             .position_rad = 0.1234,
             .round_trip_s = 0.4e-3,
             .longest_round_trip_s = 1.1e-3,
             .temperature_degc = 31.0,
             .voltage_v = std::numeric_limits<double>::quiet_NaN()};
  }
  f.imu = ImuFindings{
      .figures = {.samples = 200, .rate_hz = 500.0, .acceleration_mps2 = {0.0, 0.0, 9.8}},
      .state = "streaming"};
  f.emergency_stop = "emergency stop, /dev/gpiochip0 line 4: not pressed";
  return f;
}

TEST(CheckReportTest, ShowsEveryJointAndThatAllIsWell) {
  const std::string report =
      check_report(example_hardware("mit"), example_robot(), example_gate(), good_findings());
  EXPECT_THAT(report, HasSubstr("can3          1 2 3"));
  EXPECT_THAT(report, HasSubstr("RH_KFE        can3         3   200/200   0.40  1.10     0.1234 "
                                "(-2.50 to 2.50)"));
  EXPECT_THAT(report, HasSubstr("500.0 of 500 samples/s, |a| 9.800 m/s^2"));
  EXPECT_THAT(report, HasSubstr("\nemergency stop, /dev/gpiochip0 line 4: not pressed\n"));
  EXPECT_THAT(report, HasSubstr("nothing is wrong"));
}

TEST(CheckReportTest, ListsProblemsAndSilentDrives) {
  CheckFindings findings = good_findings();
  findings.drives[0] = {.requests = 200};
  findings.problems = {"one", "another"};
  const std::string report =
      check_report(example_hardware("mit"), example_robot(), example_gate(), findings);
  EXPECT_THAT(report, HasSubstr("0/200  silent"));
  EXPECT_THAT(report, HasSubstr("2 things are wrong; nothing was powered\n  one\n  another\n"));
  EXPECT_THAT(report, Not(HasSubstr("nothing is wrong")));
}

TEST(CheckReportTest, SaysWhatWasPushedAndThatDrivesWereOn) {
  CheckFindings findings = good_findings();
  findings.nudges = {"LF_KFE: moved"};
  findings.powered = true;
  const std::string report =
      check_report(example_hardware("mit"), example_robot(), example_gate(), findings);
  EXPECT_THAT(report, HasSubstr("pushed by its own drive\n  LF_KFE: moved\n"));
  EXPECT_THAT(report, HasSubstr("nothing is wrong; the drives are off again\n"));
}

TEST(CheckReportTest, DrivesThatNobodyExpectsAreNamed) {
  const HardwareConfig config = example_hardware("mit");
  CheckFindings findings = good_findings();
  EXPECT_THAT(scan_problems(config, example_robot(), findings.scanned), IsEmpty());
  findings.scanned[1][2].id = 7;
  findings.scanned[2][0].reply_id = 0x11;
  EXPECT_THAT(scan_problems(config, example_robot(), findings.scanned),
              ElementsAre(HasSubstr("can1 id 7: a drive answers that no joint has"),
                          "LH_HAA (can2 id 1): answers under identifier 17, reply_id is 0"));
}

TEST(CheckReportTest, WhatABusShowedIsNamed) {
  std::vector<FoundBus> buses(4);
  EXPECT_THAT(bus_problems(example_hardware("mit"), buses), IsEmpty());
  buses[0].not_sent = 3;
  buses[1] = {.error_frames = 5, .error = "no node acknowledges"};
  buses[2].foreign = 2;
  EXPECT_THAT(bus_problems(example_hardware("mit"), buses),
              ElementsAre(HasSubstr("can0: 3 frames were not taken"),
                          HasSubstr("can1: 5 error frames, last: no node acknowledges"),
                          HasSubstr("can2: 2 frames that are no reply")));
}

}  // namespace
}  // namespace sandrunner
