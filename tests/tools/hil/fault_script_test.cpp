// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/fault_script.h"

#include <gtest/gtest.h>

#include "tests/support/error_of.h"
#include "tests/tools/hil/bench_examples.h"
#include "tools/hil/fault_clock.h"

namespace sandrunner::hil {
namespace {

TimedFault fault(const std::string& text, const std::string& example = "moteus") {
  return read_faults(bench_example(example), {text}).at(0);
}

std::string refusal(const std::string& text, const std::string& example = "moteus") {
  return error_of([&] { fault(text, example); });
}

TEST(FaultScriptTest, SaysWhenWhatAndWhere) {
  const TimedFault jump = fault("1.5 jumps RF_KFE -0.25");
  EXPECT_EQ(jump.at_s, 1.5);
  EXPECT_FALSE(jump.from_start);
  EXPECT_EQ(jump.kind, "jumps");
  EXPECT_EQ(jump.first, 5);
  EXPECT_EQ(jump.value, -0.25);
  EXPECT_EQ(fault("0 bus-off can2").first, 2);
  const TimedFault swapped = fault("start swapped LF_HFE LF_KFE");
  EXPECT_TRUE(swapped.from_start);
  EXPECT_EQ(swapped.at_s, 0.0);
  EXPECT_EQ(swapped.second, 2);
  const TimedFault turned = fault("start+2.5 turns LF_HFE -0.5");
  EXPECT_TRUE(turned.from_start);
  EXPECT_EQ(turned.at_s, 2.5);
  EXPECT_EQ(turned.value, -0.5);
  EXPECT_EQ(fault("6 kill").kind, "kill");
  const TimedFault hot = fault("2.5 hot FL_calf_joint 90", "unitree");
  EXPECT_EQ(hot.kind, "hot");
  EXPECT_EQ(hot.first, 2);
  EXPECT_EQ(hot.value, 90.0);
  EXPECT_EQ(fault("1 gap 20", "unitree").value, 20.0);
  EXPECT_EQ(fault("1 wire-kill", "unitree").kind, "wire-kill");
}

TEST(FaultScriptTest, WhatItDoesNotUnderstandIsNamed) {
  EXPECT_EQ(refusal("soon silent LF_KFE"),
            "--fault 'soon silent LF_KFE': found 'soon', expected a time in s, start, or start+S");
  EXPECT_EQ(refusal("1 bus-off can9"),
            "--fault '1 bus-off can9': found 'can9', expected one of can0, can1, can2, can3");
  EXPECT_EQ(refusal("1 jumps LF_KFE"),
            "--fault '1 jumps LF_KFE': found no more, expected a number");
  EXPECT_EQ(refusal("1 dead now"), "--fault '1 dead now': found 'now', expected no more");
  EXPECT_EQ(refusal("1 gap", "unitree"), "--fault '1 gap': found no more, expected a number");
  EXPECT_NE(refusal("1 explode", "unitree").find("found 'explode', expected one of gap, burst"),
            std::string::npos);
  EXPECT_NE(refusal("-1 dead").find("a negative time"), std::string::npos);
  for (const char* const text :
       {"1 broken", "start+ dead", "start5 dead", "starting dead", "1 silent LF_XYZ", "1 gap 20"}) {
    EXPECT_NE(refusal(text), "") << text;
  }
}

TEST(FaultClockTest, MakesFaultsInTheOrderOfTheirTimesOnce) {
  FaultClock clock(
      read_faults(bench_example("moteus"), {"2 dead", "1 imu-silent", "start+3 kill"}));
  EXPECT_EQ(clock.due(2.9, {}), nullptr);
  EXPECT_EQ(clock.due(3.0, {})->kind, "kill");
  EXPECT_EQ(clock.due(9.0, {}), nullptr);  // nothing was enabled
  EXPECT_EQ(clock.due(9.0, 7.5)->kind, "imu-silent");
  EXPECT_EQ(clock.due(9.0, 7.5), nullptr);
  EXPECT_FALSE(clock.all_made());
  EXPECT_EQ(clock.due(9.5, 7.5)->kind, "dead");
  EXPECT_TRUE(clock.all_made());
  EXPECT_EQ(clock.due(99.0, 7.5), nullptr);
}

}  // namespace
}  // namespace sandrunner::hil
