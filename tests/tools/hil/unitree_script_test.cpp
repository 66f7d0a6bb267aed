// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/unitree_script.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "rt/base/errors.h"
#include "rt/core/faults.h"
#include "rt/core/messages.h"
#include "rt/core/warnings.h"
#include "tests/support/joint_names.h"
#include "tools/hil/unitree_runs.h"

namespace sandrunner::hil {
namespace {

RobotDescription robot() {
  RobotDescription robot;
  for (int j = 0; j < kNumJoints; ++j) robot.joint_names[j] = kJointNames[j];
  return robot;
}

std::string refusal_of(const std::string& text) {
  try {
    read_unitree_fault(text, robot());
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(UnitreeScriptTest, SaysWhenWhatAndWhere) {
  const TimedUnitreeFault hot = read_unitree_fault("2.5 hot LF_KFE 90", robot());
  EXPECT_EQ(hot.at_s, 2.5);
  EXPECT_FALSE(hot.from_start);
  EXPECT_EQ(hot.kind, UnitreeFaultKind::kHot);
  EXPECT_EQ(hot.joint, 2);
  EXPECT_EQ(hot.value, 90.0);
  EXPECT_TRUE(read_unitree_fault("start firmware-damps", robot()).from_start);
}

TEST(UnitreeScriptTest, RefusesWhatItCannotMake) {
  EXPECT_EQ(refusal_of("1 gap"), "--fault '1 gap': found no more, expected a number");
  EXPECT_NE(refusal_of("soon silent").find("found 'soon', expected a time in s"),
            std::string::npos);
  EXPECT_NE(refusal_of("-1 silent").find("a negative time"), std::string::npos);
  EXPECT_NE(refusal_of("1 explode").find("found 'explode', expected one of gap, burst"),
            std::string::npos);
  EXPECT_NE(refusal_of("1 nan LF_TOE").find("found 'LF_TOE'"), std::string::npos);
  EXPECT_NE(refusal_of("1 silent now").find("found 'now', expected no more"), std::string::npos);
}

TEST(UnitreeRunsTest, EachCanBeReadAndNamesAFaultThatThereIs) {
  for (const UnitreeRun& run : unitree_runs()) {
    for (const char* const script : {run.first, run.fault}) {
      if (*script == '\0') continue;
      EXPECT_NO_THROW(
          read_unitree_fault(fmt::format(fmt::runtime(script), kJointNames[2]), robot()))
          << run.name;
    }
    const bool known = std::ranges::any_of(
        kFaultTable, [&](const FaultRow& row) { return std::string(row.name) == run.bit; });
    const bool warns = std::ranges::any_of(
        kWarningTable, [&](const WarningRow& row) { return std::string(row.name) == run.bit; });
    EXPECT_TRUE(known || warns || *run.bit == '\0') << run.name;
  }
}

TEST(UnitreeRunsTest, StandInTheReadmeAsTheyAreInTheCode) {
  std::ostringstream text;
  text << std::ifstream(SANDRUNNER_UNITREE_README).rdbuf();
  const std::string table = unitree_run_markdown();
  EXPECT_NE(text.str().find(table), std::string::npos) << "drivers/unitree/README.md should have:\n"
                                                       << table;
}

}  // namespace
}  // namespace sandrunner::hil
