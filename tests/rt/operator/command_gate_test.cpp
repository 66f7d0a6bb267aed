// SPDX-License-Identifier: BSD-3-Clause
#include "rt/operator/command_gate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace sandrunner {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kStale = 300 * kMs;
const Twist kForward{.linear_mps = {1.0, 0.0, 0.0}};

TEST(CommandGateTest, AnyNumberThatIsNotFiniteIsRefused) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    for (int i = 0; i < 3; ++i) {
      CommandGate gate(kStale);
      Twist linear, angular;
      linear.linear_mps[i] = bad;
      angular.angular_radps[i] = bad;
      EXPECT_EQ(gate.judge(linear, 1, 0), CommandVerdict::kNotFinite);
      EXPECT_EQ(gate.judge(angular, 1, 0), CommandVerdict::kNotFinite);
    }
  }
}

TEST(CommandGateTest, AbsurdSpeedsAreRefusedAndTheLimitsThemselvesPass) {
  CommandGate gate(kStale);
  EXPECT_EQ(gate.judge({.linear_mps = {1e9, 0.0, 0.0}}, 1, 0), CommandVerdict::kAbsurd);
  EXPECT_EQ(gate.judge({.linear_mps = {0.0, -5.01, 0.0}}, 1, 0), CommandVerdict::kAbsurd);
  EXPECT_EQ(gate.judge({.angular_radps = {0.0, 0.0, 10.01}}, 1, 0), CommandVerdict::kAbsurd);
  EXPECT_EQ(gate.judge({.linear_mps = {-5.0, 5.0, 0.0}, .angular_radps = {0.0, 0.0, -10.0}}, 1, 0),
            CommandVerdict::kAccepted);
}

TEST(CommandGateTest, TheFirstPublisherHoldsTheCommandUntilItIsStale) {
  CommandGate gate(kStale);
  EXPECT_EQ(gate.judge(kForward, 1, 0), CommandVerdict::kAccepted);
  EXPECT_EQ(gate.judge(kForward, 2, 10 * kMs), CommandVerdict::kOtherPublisher);
  EXPECT_EQ(gate.judge(kForward, 1, 250 * kMs), CommandVerdict::kAccepted);
  EXPECT_EQ(gate.judge(kForward, 2, 550 * kMs), CommandVerdict::kOtherPublisher);
  EXPECT_EQ(gate.judge(kForward, 2, 551 * kMs), CommandVerdict::kAccepted);
  EXPECT_EQ(gate.judge(kForward, 1, 552 * kMs), CommandVerdict::kOtherPublisher);
}

TEST(CommandGateTest, ARefusedCommandHoldsNothing) {
  CommandGate gate(kStale);
  EXPECT_EQ(gate.judge({.linear_mps = {1e9, 0.0, 0.0}}, 1, 0), CommandVerdict::kAbsurd);
  EXPECT_EQ(gate.judge(kForward, 2, 1 * kMs), CommandVerdict::kAccepted);
  // Nor does one from the holder: it does not prolong the hold.
  EXPECT_EQ(gate.judge({.linear_mps = {NAN, 0.0, 0.0}}, 2, 200 * kMs), CommandVerdict::kNotFinite);
  EXPECT_EQ(gate.judge(kForward, 1, 302 * kMs), CommandVerdict::kAccepted);
}

}  // namespace
}  // namespace sandrunner
