// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/fault_script.h"

#include <gtest/gtest.h>

#include "rt/base/errors.h"
#include "tests/drivers/robot/example.h"

namespace sandrunner::hil {
namespace {

TimedFault fault(const std::string& text) {
  return read_fault(text, example_hardware("moteus"), example_robot());
}

std::string refusal(const std::string& text) {
  try {
    fault(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(FaultScriptTest, SaysWhenWhatAndWhere) {
  const TimedFault jump = fault("1.5 jumps RF_KFE -0.25");
  EXPECT_EQ(jump.at_s, 1.5);
  EXPECT_EQ(jump.kind, BenchFault::kJumps);
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
  EXPECT_EQ(fault("6 foreign RF_HFE 1000").kind, BenchFault::kForeign);
}

TEST(FaultScriptTest, WhatItDoesNotUnderstandIsNamed) {
  EXPECT_EQ(refusal("soon silent LF_KFE"),
            "--fault 'soon silent LF_KFE': found 'soon', expected a time in s, start, or start+S");
  EXPECT_EQ(refusal("1 bus-off can9"),
            "--fault '1 bus-off can9': found 'can9', expected one of can0, can1, can2, can3");
  EXPECT_EQ(refusal("1 jumps LF_KFE"),
            "--fault '1 jumps LF_KFE': found no more, expected a number");
  EXPECT_EQ(refusal("1 dead now"), "--fault '1 dead now': found 'now', expected no more");
  EXPECT_NE(refusal("1 broken"), "");
  EXPECT_NE(refusal("-1 dead"), "");
  EXPECT_NE(refusal("start+ dead"), "");
  EXPECT_NE(refusal("start5 dead"), "");
  EXPECT_NE(refusal("starting dead"), "");
  EXPECT_NE(refusal("1 silent LF_XYZ"), "");
}

}  // namespace
}  // namespace sandrunner::hil
