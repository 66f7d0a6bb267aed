// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/unitree/unitree_check.h"

#include <gmock/gmock.h>

#include "tests/support/joint_names.h"

namespace sandrunner {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class UnitreeCheckTest : public testing::Test {
 protected:
  UnitreeCheckTest() {
    config_.interface = "eth0";
    for (int j = 0; j < kNumJoints; ++j) robot_.joint_names[j] = kJointNames[j];
    robot_.lower_rad.fill(-2.7);
    robot_.upper_rad.fill(2.7);
    unitree::StateFigures& f = findings_.states;
    f.counters.taken = 250;
    f.rate_hz = 500.0;
    f.longest_gap_s = 0.0023;
    f.tick_rate_hz = 1000.0;
    f.state.battery_percent = 80;
    f.state.supply_v = 29.0;
    f.state.remote.on = true;
    f.state.position_rad[2] = -2.5;
    findings_.commands_are_read = true;
    findings_.mode = "";
  }
  std::vector<std::string> problems() const {
    return unitree_check_problems(config_, robot_, findings_);
  }

  UnitreeConfig config_;
  unitree::RobotFigures robot_;
  UnitreeFindings findings_;
};

TEST_F(UnitreeCheckTest, ARobotThatIsWellHasNoProblem) {
  EXPECT_THAT(problems(), IsEmpty());
  const std::string report = unitree_check_report(config_, robot_, findings_);
  EXPECT_THAT(report, HasSubstr("rt/lowstate: 500 states a second, longest gap 2.3 ms, clock 1000 "
                                "Hz, CRC good\n"));
  EXPECT_THAT(report, HasSubstr("LF_KFE              5    -2.500   -2.700    2.700"));
  EXPECT_THAT(report, HasSubstr("battery 80 %, 29.0 V, 0.0 A; remote on\n"));
  EXPECT_THAT(report, HasSubstr("sport mode: off\n"));
  EXPECT_THAT(report, HasSubstr("all is well; nothing was powered\n"));
}

TEST_F(UnitreeCheckTest, AKneeAtItsStopIsWellAndOneFarPastItIsNot) {
  findings_.states.state.position_rad[2] = -2.703;
  EXPECT_THAT(unitree_check_report(config_, robot_, findings_), Not(HasSubstr("past its stop")));
  findings_.states.state.position_rad[2] = -2.75;
  EXPECT_THAT(problems(), IsEmpty());
  EXPECT_THAT(unitree_check_report(config_, robot_, findings_), HasSubstr("past its stop"));
  findings_.states.state.position_rad[2] = -2.81;
  EXPECT_THAT(problems(), ElementsAre(HasSubstr("LF_KFE: found it at -2.810 rad, expected")));
}

TEST_F(UnitreeCheckTest, NamesWhatIsWrong) {
  unitree::StateFigures& f = findings_.states;
  f.rate_hz = 250.0;
  f.tick_rate_hz = 500.0;
  f.counters.bad_crc = 10;
  f.state.battery_percent = 5;
  f.state.remote.on = false;
  f.state.temperature_degc[3] = 90;
  findings_.commands_are_read = false;
  findings_.foreign_commands = 3;
  EXPECT_THAT(
      problems(),
      ElementsAre(HasSubstr("10 of 260 states with a wrong CRC"),
                  HasSubstr("250 states a second, expected 500"),
                  HasSubstr("500 ticks a second, expected 1000"),
                  HasSubstr("RF_HAA: found 90 degrees C"), HasSubstr("battery: found 5 %"),
                  HasSubstr("remote control: found none"), HasSubstr("no reader of commands"),
                  HasSubstr("3 commands of another program")));
}

TEST_F(UnitreeCheckTest, NoStatesIsTheOneThingThatIsSaidOfThem) {
  findings_.states = {};
  EXPECT_THAT(problems(), ElementsAre(HasSubstr("found no state in 3 s on interface eth0")));
  findings_.wrong_state_type = true;
  EXPECT_THAT(problems(), ElementsAre(HasSubstr("found another type")));
}

TEST_F(UnitreeCheckTest, SportModeCommandsTheRobotWhileItIsOn) {
  findings_.mode = "ai";
  findings_.foreign_commands = 500;
  EXPECT_THAT(problems(), IsEmpty());
  EXPECT_THAT(unitree_check_report(config_, robot_, findings_),
              HasSubstr("sport mode: 'ai' is on; a run switches it off while the robot lies\n"));
}

TEST_F(UnitreeCheckTest, ASwitcherThatDoesNotAnswerIsAProblemUnlessItIsNotNeeded) {
  findings_.mode.reset();
  EXPECT_THAT(problems(), ElementsAre(HasSubstr("motion_switcher: found no answer")));
  config_.release_sport_mode = false;
  EXPECT_THAT(problems(), IsEmpty());
}

}  // namespace
}  // namespace sandrunner
