// SPDX-License-Identifier: BSD-3-Clause
// The script alone, told what the robot does.
#include "rt/run/run_script.h"

#include <gtest/gtest.h>

namespace sandrunner {
namespace {

constexpr std::uint64_t kSettle_ticks = 4000, kDamping_ticks = 4000;

class RunScriptTest : public testing::Test {
 protected:
  /// Armed: its next request is to stand up.
  RunScript walk_from_lying() const {
    RunScript script(source_, {.walk_s = 2.0}, true);
    arm(script);
    return script;
  }
  RunScript walk_at_once() const { return {source_, {.walk_s = 2.0, .start_walking = true}, true}; }

  static OperatorVerdict in(RunScript& script, Mode mode, std::uint64_t ticks = 1) {
    return script.advance({.ticks = ticks, .mode = mode});
  }
  /// Ticks in `mode` until the request changes or the run ends.
  static std::uint64_t ticks_in(RunScript& script, Mode mode) {
    const std::uint64_t id = script.command(0).request_id;
    std::uint64_t ticks = 0;
    do {
      ++ticks;
    } while (in(script, mode).goes_on() && script.command(0).request_id == id && ticks < 100000);
    return ticks;
  }
  static void arm(RunScript& script) {
    EXPECT_EQ(asked(script), ModeRequest::kArm);
    EXPECT_TRUE(in(script, Mode::kPassive).goes_on());
    EXPECT_TRUE(in(script, Mode::kDamping).goes_on());
  }
  static ModeRequest asked(RunScript& script) { return script.command(0).request; }
  /// Brings walk_from_lying() into Walk.
  static void stand_up(RunScript& script) {
    ticks_in(script, Mode::kStand);
    ASSERT_EQ(asked(script), ModeRequest::kWalk);
  }

  const CommandSource source_{"1,0.5,-0.25"};
};

TEST_F(RunScriptTest, AWarningLaysTheRobotDownAndFailsTheRun) {
  RunScript script = walk_from_lying();
  stand_up(script);
  EXPECT_TRUE(script.advance({.mode = Mode::kWalk, .warnings = 1}).goes_on());
  EXPECT_EQ(asked(script), ModeRequest::kLie);
  EXPECT_STREQ(script.fall_reason(), "drive_warning");
  EXPECT_TRUE(in(script, Mode::kStand).goes_on());
  EXPECT_EQ(ticks_in(script, Mode::kDamping), kDamping_ticks);
}

TEST_F(RunScriptTest, AFaultAfterAWarningIsTheReason) {
  RunScript script = walk_from_lying();
  stand_up(script);
  script.advance({.mode = Mode::kWalk, .warnings = 4});
  EXPECT_STREQ(script.fall_reason(), "imu_late");
  script.advance({.mode = Mode::kFault,
                  .faults = fault_bit(Fault::kImuStale),
                  .first_fault = Fault::kImuStale,
                  .warnings = 4});
  EXPECT_STREQ(script.fall_reason(), "imu_stale");
  EXPECT_EQ(asked(script), ModeRequest::kDamp);
}

TEST_F(RunScriptTest, StandsUpSettlesWalksStopsWaitsAndLiesDown) {
  RunScript script = walk_from_lying();
  EXPECT_EQ(asked(script), ModeRequest::kStand);
  for (int i = 0; i < 9000; ++i) ASSERT_TRUE(in(script, Mode::kStandUp).goes_on());
  EXPECT_EQ(asked(script), ModeRequest::kStand);
  EXPECT_EQ(ticks_in(script, Mode::kStand), kSettle_ticks);
  EXPECT_EQ(asked(script), ModeRequest::kWalk);
  for (int i = 0; i < 50; ++i) EXPECT_FALSE(in(script, Mode::kStand).counts);  // not yet in Walk
  EXPECT_EQ(ticks_in(script, Mode::kWalk), 8000u);
  EXPECT_EQ(asked(script), ModeRequest::kStand);
  EXPECT_FALSE(in(script, Mode::kWalk).counts);  // the stop is no part of the walk
  EXPECT_EQ(ticks_in(script, Mode::kStand), 2 * kSettle_ticks);
  EXPECT_EQ(asked(script), ModeRequest::kLie);
  for (int i = 0; i < 6000; ++i) {
    ASSERT_TRUE(script.advance({.mode = Mode::kStand, .thigh_contact = true}).goes_on());
  }
  const TickFacts down{.mode = Mode::kDamping, .base_contact = true, .thigh_contact = true};
  std::uint64_t ticks = 1;
  while (script.advance(down).goes_on()) ++ticks;
  EXPECT_EQ(ticks, kDamping_ticks);
  EXPECT_TRUE(script.survived());
  EXPECT_FALSE(script.interrupted());
  EXPECT_DOUBLE_EQ(script.walked_s(), 2.0);
}

TEST_F(RunScriptTest, WithoutPolicyLiesDownWhenItHasStood) {
  RunScript script(source_, {}, false);
  arm(script);
  EXPECT_EQ(asked(script), ModeRequest::kStand);
  EXPECT_EQ(ticks_in(script, Mode::kStand), kSettle_ticks);
  EXPECT_EQ(asked(script), ModeRequest::kLie);
  EXPECT_EQ(ticks_in(script, Mode::kDamping), kDamping_ticks);
  EXPECT_TRUE(script.survived());
}

TEST_F(RunScriptTest, AFaultWhileItIsLetDownAtTheEndCounts) {
  RunScript script = walk_from_lying();
  stand_up(script);
  ticks_in(script, Mode::kWalk);
  ticks_in(script, Mode::kStand);
  script.advance({.mode = Mode::kFault,
                  .faults = static_cast<std::uint64_t>(Fault::kDriveFault),
                  .first_fault = Fault::kDriveFault});
  EXPECT_STREQ(script.fall_reason(), "drive_fault");
  EXPECT_EQ(script.fall_mode(), Mode::kStand);
}

TEST_F(RunScriptTest, StartInWalkAsksForNothingAndEndsWithTheTime) {
  RunScript script = walk_at_once();
  EXPECT_EQ(script.command(0).request_id, 0u);
  EXPECT_TRUE(in(script, Mode::kWalk).counts);
  EXPECT_EQ(ticks_in(script, Mode::kWalk), 7999u);
  EXPECT_EQ(script.command(0).request_id, 0u);
  EXPECT_TRUE(script.survived());
}

TEST_F(RunScriptTest, SettlingBeginsAnewWhenStandIsLeft) {
  RunScript script = walk_from_lying();
  in(script, Mode::kStand, kSettle_ticks - 1);
  in(script, Mode::kStandUp);
  EXPECT_EQ(ticks_in(script, Mode::kStand), kSettle_ticks);
}

TEST_F(RunScriptTest, CommandsTheVelocityOnlyToWalk) {
  RunScript script = walk_from_lying();
  EXPECT_EQ(script.command(17).tick, 17u);
  EXPECT_EQ(script.command(17).velocity.vx_mps, 0.0);
  stand_up(script);
  EXPECT_EQ(script.command(18).velocity.vx_mps, 1.0);
  EXPECT_EQ(script.command(18).velocity.vy_mps, 0.5);
  EXPECT_EQ(script.command(18).velocity.wz_radps, -0.25);
  ticks_in(script, Mode::kWalk);
  EXPECT_EQ(script.command(19).velocity.vx_mps, 0.0);
  EXPECT_EQ(script.command(19).velocity.wz_radps, 0.0);
}

TEST_F(RunScriptTest, SkippedSlotsCountAsTime) {
  RunScript script = walk_from_lying();
  for (int i = 0; i < 800; ++i) {
    EXPECT_EQ(asked(script), ModeRequest::kStand);
    in(script, Mode::kStand, 5);  // 4 of 5 slots are skipped
  }
  EXPECT_EQ(asked(script), ModeRequest::kWalk);
  in(script, Mode::kWalk, 4000);
  EXPECT_DOUBLE_EQ(script.walked_s(), 1.0);
  EXPECT_EQ(ticks_in(script, Mode::kWalk), 4000u);
  in(script, Mode::kStand, 2 * kSettle_ticks - 1);
  EXPECT_EQ(asked(script), ModeRequest::kStand);
  in(script, Mode::kStand);
  EXPECT_EQ(asked(script), ModeRequest::kLie);
}

TEST_F(RunScriptTest, TouchingTheGroundAfterTheFirstStepIsAFall) {
  for (const bool base : {true, false}) {
    RunScript script = walk_from_lying();
    const TickFacts lying{.mode = Mode::kStandUp, .base_contact = base, .thigh_contact = !base};
    for (int i = 0; i < 100; ++i) EXPECT_TRUE(script.advance(lying).goes_on());
    EXPECT_TRUE(script.survived());  // it has not walked yet
    stand_up(script);
    in(script, Mode::kWalk, 1000);
    const TickFacts fallen{.mode = Mode::kWalk, .base_contact = base, .thigh_contact = !base};
    EXPECT_TRUE(script.advance(fallen).counts);
    EXPECT_FALSE(script.survived());
    EXPECT_STREQ(script.fall_reason(), base ? "base_contact" : "thigh_contact");
    EXPECT_DOUBLE_EQ(script.fall_time_s(), 0.25);
    EXPECT_EQ(asked(script), ModeRequest::kDamp);
    EXPECT_EQ(script.command(0).velocity.vx_mps, 0.0);
    EXPECT_EQ(ticks_in(script, Mode::kDamping), kDamping_ticks - 1);
  }
}

TEST_F(RunScriptTest, FallWhileItStopsCounts) {
  RunScript script = walk_from_lying();
  stand_up(script);
  ticks_in(script, Mode::kWalk);
  script.advance({.mode = Mode::kStand, .thigh_contact = true});
  EXPECT_STREQ(script.fall_reason(), "thigh_contact");
  EXPECT_EQ(script.fall_mode(), Mode::kStand);
  EXPECT_DOUBLE_EQ(script.fall_time_s(), 2.0);
}

TEST_F(RunScriptTest, BaseOnTheGroundAfterStandingUpDidNotStand) {
  for (const bool has_policy : {true, false}) {
    RunScript script(source_, {}, has_policy);
    arm(script);
    in(script, Mode::kStand, kSettle_ticks - 1);
    EXPECT_TRUE(script.survived());
    EXPECT_TRUE(script.advance({.mode = Mode::kStand, .base_contact = true}).goes_on());
    EXPECT_STREQ(script.fall_reason(), "did_not_stand");
    EXPECT_EQ(asked(script), ModeRequest::kDamp);
  }
}

TEST_F(RunScriptTest, FirstReasonStaysWhateverFollows) {
  RunScript script = walk_at_once();
  in(script, Mode::kWalk, 400);
  script.advance({.mode = Mode::kFault,
                  .faults = static_cast<std::uint64_t>(Fault::kTilt),
                  .first_fault = Fault::kTilt,
                  .base_contact = true});
  EXPECT_STREQ(script.fall_reason(), "tilt");
  const std::uint64_t id = script.command(0).request_id;
  script.advance({.mode = Mode::kFault, .thigh_contact = true, .interrupts = 1});
  EXPECT_STREQ(script.fall_reason(), "tilt");
  EXPECT_DOUBLE_EQ(script.fall_time_s(), 0.1);
  EXPECT_EQ(script.fall_mode(), Mode::kWalk);  // the one that the fault ended
  EXPECT_TRUE(script.interrupted());
  EXPECT_EQ(script.command(0).request_id, id);  // damping was asked for once
}

TEST_F(RunScriptTest, FaultInTheFirstTickEndsTheModeInWhichTheRunBegan) {
  RunScript script = walk_at_once();
  script.advance({.mode = Mode::kFault,
                  .faults = static_cast<std::uint64_t>(Fault::kTilt),
                  .first_fault = Fault::kTilt});
  EXPECT_EQ(script.fall_mode(), Mode::kWalk);
}

TEST_F(RunScriptTest, InterruptLiesDownInAnyPhaseAndIsNoFall) {
  for (const int phase : {0, 1, 2}) {
    RunScript script = walk_from_lying();
    if (phase > 0) stand_up(script);
    if (phase > 1) ticks_in(script, Mode::kWalk);
    EXPECT_TRUE(script.advance({.mode = Mode::kStand, .interrupts = 1}).goes_on());
    EXPECT_EQ(asked(script), ModeRequest::kLie);
    const TickFacts lowered{.mode = Mode::kStand, .thigh_contact = true, .interrupts = 1};
    for (int i = 0; i < 6000; ++i) ASSERT_TRUE(script.advance(lowered).goes_on());
    const TickFacts down{.mode = Mode::kDamping, .base_contact = true, .interrupts = 1};
    std::uint64_t ticks = 1;
    while (script.advance(down).goes_on()) ++ticks;
    EXPECT_EQ(ticks, kDamping_ticks);
    EXPECT_EQ(asked(script), ModeRequest::kLie);
    EXPECT_TRUE(script.survived());
    EXPECT_TRUE(script.interrupted());
  }
}

TEST_F(RunScriptTest, ASecondInterruptDampsAtOnce) {
  RunScript script = walk_from_lying();
  stand_up(script);
  script.advance({.mode = Mode::kWalk, .interrupts = 1});
  script.advance({.mode = Mode::kWalk, .interrupts = 2});
  EXPECT_EQ(asked(script), ModeRequest::kDamp);
}

TEST_F(RunScriptTest, AFaultAfterAnInterruptDampsForItsTime) {
  RunScript script = walk_at_once();
  script.advance({.mode = Mode::kWalk, .interrupts = 1});
  std::uint64_t ticks = 1;
  while (script.advance({.mode = Mode::kFault, .faults = 1, .interrupts = 1}).goes_on()) ++ticks;
  EXPECT_EQ(ticks, kDamping_ticks);
}

TEST_F(RunScriptTest, ARobotThatDoesNotLieDownIsDampedAfterFiveSeconds) {
  RunScript script = walk_at_once();
  script.advance({.mode = Mode::kWalk, .interrupts = 1});
  EXPECT_EQ(ticks_in(script, Mode::kWalk), 5 * kControlHz - 1U);
  EXPECT_EQ(asked(script), ModeRequest::kDamp);
}

TEST_F(RunScriptTest, StallThatFaultsIsStillDampedForItsTime) {
  RunScript script = walk_at_once();
  const OperatorVerdict verdict =
      script.advance({.ticks = 3 * kDamping_ticks,
                      .mode = Mode::kFault,
                      .faults = static_cast<std::uint64_t>(Fault::kPolicyStale),
                      .first_fault = Fault::kPolicyStale});
  EXPECT_TRUE(verdict.goes_on());
  EXPECT_STREQ(script.fall_reason(), "policy_stale");
  EXPECT_EQ(ticks_in(script, Mode::kFault), kDamping_ticks - 1);
}

}  // namespace
}  // namespace sandrunner
