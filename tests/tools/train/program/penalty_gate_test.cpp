// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/penalty_gate.h"

#include <gtest/gtest.h>

namespace sandrunner::train {
namespace {

constexpr double kTrackedError = 0.15;
// The penalties rise by 0.1 in 1 of 100 transitions; the last 40 settle; the first 5 wait.
constexpr GateSettings kSettings{
    .enabled = true, .least_alive = 0.9, .rise_transitions = 10.0, .back_rate = 0.5};

PenaltyGate make_gate(const GateSettings& settings = kSettings) {
  return PenaltyGate(settings, kTrackedError, 100.0, 0.4, 5.0);
}
BatteryFigures figures(double alive, double error) {
  BatteryFigures f;
  f.alive = alive;
  f.error = error;
  return f;
}
const BatteryFigures kPassed = figures(0.95, 0.1), kFalls = figures(0.85, 0.1),
                     kStands = figures(1.0, 0.9);

TEST(PenaltyGateTest, PenaltiesRiseWhileTheBatteryIsPassedAndGoBackWhileItIsNot) {
  PenaltyGate gate = make_gate();
  gate.advance(10.0);
  EXPECT_EQ(gate.late(), 0.0);  // not judged yet
  gate.judge(kPassed);
  gate.advance(14.0);
  EXPECT_NEAR(gate.late(), 0.4, 1e-12);
  gate.judge(kFalls);
  gate.advance(16.0);
  EXPECT_NEAR(gate.late(), 0.3, 1e-12);
  gate.judge(kStands);
  gate.advance(18.0);
  EXPECT_NEAR(gate.late(), 0.2, 1e-12);
  gate.advance(40.0);
  EXPECT_EQ(gate.late(), 0.0);
  gate.judge(kPassed);
  gate.advance(55.0);
  EXPECT_EQ(gate.late(), 1.0);
}

TEST(PenaltyGateTest, NothingRisesBeforeTheGaitPriorFades) {
  PenaltyGate gate = make_gate();
  gate.judge(kPassed);
  gate.advance(5.0);
  EXPECT_EQ(gate.late(), 0.0);
  gate.advance(6.0);
  EXPECT_NEAR(gate.late(), 0.1, 1e-12);
}

TEST(PenaltyGateTest, PenaltiesGoOnRisingWhileATrainingSettles) {
  PenaltyGate gate = make_gate();
  gate.advance(55.0);
  gate.judge(kPassed);
  gate.advance(58.0);
  EXPECT_NEAR(gate.late(), 0.3, 1e-12);
  EXPECT_EQ(gate.unsettled(), 1.0);
  gate.advance(61.0);
  EXPECT_NEAR(gate.late(), 0.6, 1e-12);
  EXPECT_NEAR(gate.unsettled(), 39.0 / 40.0, 1e-12);
  gate.advance(80.0);
  EXPECT_EQ(gate.late(), 1.0);
  gate.advance(100.0);
  EXPECT_EQ(gate.unsettled(), 0.0);
}

TEST(PenaltyGateTest, WithoutAWayBackPenaltiesWaitWhereTheyAre) {
  GateSettings settings = kSettings;
  settings.back_rate = 0.0;
  PenaltyGate gate = make_gate(settings);
  gate.judge(kPassed);
  gate.advance(5.0);
  gate.advance(8.0);
  EXPECT_NEAR(gate.late(), 0.3, 1e-12);
  gate.judge(kFalls);
  gate.advance(50.0);
  EXPECT_NEAR(gate.late(), 0.3, 1e-12);
}

TEST(PenaltyGateTest, SwitchedOffPenaltiesRiseWhateverTheBatterySays) {
  GateSettings off = kSettings;
  off.enabled = false;
  PenaltyGate gate = make_gate(off);
  gate.judge(kFalls);
  gate.advance(5.0);
  gate.advance(10.0);
  EXPECT_NEAR(gate.late(), 0.5, 1e-12);
}

TEST(PenaltyGateTest, ItsStateIsPartOfACheckpoint) {
  PenaltyGate gate = make_gate();
  gate.judge(kPassed);
  gate.advance(10.0);
  gate.advance(13.0);
  learner::Checkpoint checkpoint;
  gate.save(checkpoint);
  PenaltyGate other = make_gate();
  other.load(checkpoint);
  gate.advance(17.0);
  other.advance(17.0);
  EXPECT_EQ(other.late(), gate.late());
}

TEST(PenaltyGateTest, ASettledTrainingThatIsMadeLongerOpensUpAgain) {
  PenaltyGate gate = make_gate();
  gate.advance(100.0);
  EXPECT_EQ(gate.unsettled(), 0.0);
  learner::Checkpoint checkpoint;
  gate.save(checkpoint);
  PenaltyGate longer(kSettings, kTrackedError, 200.0, 0.4, 5.0);
  longer.load(checkpoint);
  EXPECT_EQ(longer.unsettled(), 1.0);
}

}  // namespace
}  // namespace sandrunner::train
