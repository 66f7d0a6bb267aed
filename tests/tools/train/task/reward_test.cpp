// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/task/reward.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "tools/train/task/robot_settings.h"

namespace sandrunner::train {
namespace {

RewardSettings shipped_settings() { return shipped_task_config(sim::load_raibo()).reward; }

// A robot in its nominal posture that does exactly what is commanded.
StepOutcome obedient(float vx, float vy, float wz) {
  StepOutcome s;
  s.command = {vx, vy, wz};
  s.vx = vx;
  s.vy = vy;
  s.yaw_rate = wz;
  s.drift = s.command;
  s.body_height = 0.5f;
  s.contact = {true, true, true, true};
  for (int j = 0; j < kNumJoints; ++j) {
    s.q[j] = s.nominal[j] = j % 3 == 0 ? 0.0f : j % 3 == 1 ? 0.56f : -1.12f;
  }
  return s;
}

double rewards(const StepOutcome& s, const RewardSettings& r) {
  std::array<double, kRewardTerms> terms;
  double* value = terms.data();
  return r.rewards.add_up(s, {}, value);
}

double energy_penalty(StepOutcome s) {
  s.power = 100.0f;
  return shipped_settings().penalties.Energy::value(s, {});
}

TEST(RewardTest, StandingUnderACommandToGoEarnsLessThanHalfOfGoing) {
  const RewardSettings r = shipped_settings();
  StepOutcome standing = obedient(0.0f, 0.0f, 0.0f);
  standing.command = {1.0f, 0.0f, 0.0f};
  EXPECT_LT(rewards(standing, r), 0.5 * rewards(obedient(1.0f, 0.0f, 0.0f), r));
}

/// Mean reward over a stride in which the motion swings by a half about `share` of the
/// command, and its mean over 0.3 s by a twentieth.
double rewards_over_a_stride(std::array<float, 3> command, double share) {
  constexpr int kPhases = 16;
  double sum = 0.0;
  for (int i = 0; i < kPhases; ++i) {
    const double swing = std::sin(2.0 * M_PI * (i + 0.5) / kPhases);
    const auto now = static_cast<float>(share + swing / 2.0);
    const auto mean = static_cast<float>(share + swing / 20.0);
    StepOutcome s = obedient(command[0], command[1], command[2]);
    s.vx *= now;
    s.vy *= now;
    s.yaw_rate *= now;
    for (float& drift : s.drift) drift *= mean;
    sum += rewards(s, shipped_settings());
  }
  return sum / kPhases;
}

TEST(RewardTest, MotionThatSwingsAboutTheCommandEarnsMostWithItsMeanAtTheCommand) {
  for (const std::array<float, 3> command :
       {std::array{0.5f, 0.0f, 0.0f}, {0.0f, 0.5f, 0.0f}, {0.0f, 0.0f, 0.5f}, {2.0f, 0.0f, 0.0f}}) {
    const double at = rewards_over_a_stride(command, 1.0);
    EXPECT_GT(at, rewards_over_a_stride(command, 1.04)) << command[0] << command[1] << command[2];
    EXPECT_GT(at, rewards_over_a_stride(command, 0.96)) << command[0] << command[1] << command[2];
  }
}

TEST(RewardTest, EnergyIsPenalisedPerDistanceAndNotPerTime) {
  const double offset_mps = shipped_settings().penalties.Energy::offset_mps;
  EXPECT_NEAR(
      energy_penalty(obedient(1.0f, 0.0f, 0.0f)) / energy_penalty(obedient(3.0f, 0.0f, 0.0f)),
      (offset_mps + 3.0) / (offset_mps + 1.0), 1e-9);
}

TEST(RewardTest, EnergyIsSharedByDoubleTheWaySidewaysOrBackwardsAndByTurns) {
  const double ahead = energy_penalty(obedient(1.0f, 0.0f, 0.0f));
  EXPECT_NEAR(energy_penalty(obedient(-0.5f, 0.0f, 0.0f)), ahead, 1e-9);
  EXPECT_NEAR(energy_penalty(obedient(0.0f, 0.5f, 0.0f)), ahead, 1e-9);
  EXPECT_NEAR(energy_penalty(obedient(0.0f, -0.5f, 0.0f)), ahead, 1e-9);
  EXPECT_NEAR(energy_penalty(obedient(0.0f, 0.0f, 2.0f)), ahead, 1e-9);
  EXPECT_NEAR(energy_penalty(obedient(0.0f, 0.0f, -2.0f)), ahead, 1e-9);
}

TEST(RewardTest, DriftLosesMuchMoreThanTheSwingOfTheGait) {
  const RewardSettings r = shipped_settings();
  const StepOutcome straight = obedient(1.0f, 0.0f, 0.0f);
  StepOutcome swinging = straight, drifting = straight;
  swinging.vy = drifting.vy = 0.1f;
  drifting.drift[1] = 0.1f;
  EXPECT_LT(rewards(drifting, r), rewards(swinging, r) - 0.3);
}

TEST(RewardTest, PenaltiesGrowWithTheirRampAndMakeARewardNegativeOnlyLate) {
  const RewardSettings r = shipped_settings();
  const double fall = r.unbounded_penalties.Fall::weight;
  StepOutcome s = obedient(1.0f, 0.0f, 0.0f);
  s.power = 200.0f;
  const float early = reward_of(s, r, {.penalty = 0.1}).value;
  const float all = reward_of(s, r, {.penalty = 1.0}).value;
  const float late = reward_of(s, r, {.penalty = 1.0, .late = 1.0}).value;
  EXPECT_GT(early, all);
  EXPECT_GT(all, late);
  s.power = 1e6f;
  EXPECT_EQ(reward_of(s, r, {}).value, 0.0f);
  const float bottomless = reward_of(s, r, {.late = 1.0}).value;
  EXPECT_LT(bottomless, static_cast<float>(r.scale * r.floor));
  EXPECT_LT(-bottomless, r.scale * fall / 10.0);
  EXPECT_LT(-kPolicyHz * r.floor, fall);
}

TEST(RewardTest, BelowTheFloorASumCountsEverLessButCounts) {
  EXPECT_EQ(bounded(0.7, -0.6), 0.7);
  EXPECT_EQ(bounded(-0.6, -0.6), -0.6);
  EXPECT_NEAR(bounded(-0.6 - 1e-6, -0.6), -0.6 - 1e-6, 1e-11);  // no kink
  EXPECT_NEAR(bounded(-1.2, -0.6), -0.6 * (1.0 + std::log(2.0)), 1e-15);
  EXPECT_LT(bounded(-101.0, -0.6), bounded(-100.0, -0.6) - 1e-3);
  EXPECT_EQ(bounded(-100.0, 0.0), 0.0);
}

TEST(RewardTest, LateAStruckStopIsPenalisedByTheShareOfTheStep) {
  const RewardSettings r = shipped_settings();
  const StepOutcome free = obedient(1.0f, 0.0f, 0.0f);
  StepOutcome struck = free;
  struck.past_stop = 0.25f;
  const auto lost = [&](const RewardSchedule& schedule) {
    return reward_of(free, r, schedule).value - reward_of(struck, r, schedule).value;
  };
  EXPECT_EQ(lost({.late = 0.0}), 0.0f);
  EXPECT_NEAR(lost({.late = 1.0}), r.scale * 0.25 * r.unbounded_penalties.JointStop::weight, 1e-6);
}

TEST(RewardTest, LateAShortStrideIsPenalisedByTheTimeThatItLacks) {
  RewardSettings r = shipped_settings();
  penalty::ShortStride& stride = r.penalties;
  stride.shortest_s = 0.3;
  const StepOutcome none = obedient(1.0f, 0.0f, 0.0f);
  const auto lost = [&](std::array<float, kNumLegs> stride_s, const RewardSchedule& schedule) {
    StepOutcome s = none;
    s.stride_s = stride_s;
    return reward_of(none, r, schedule).value - reward_of(s, r, schedule).value;
  };
  const RewardSchedule late{.late = 1.0};
  EXPECT_EQ(lost({0.1f}, {.late = 0.0}), 0.0f);
  EXPECT_EQ(lost({0.3f, 0.4f}, late), 0.0f);
  EXPECT_NEAR(lost({0.2f, 0.0f, 0.25f}, late), r.scale * r.penalty.weight * stride.weight * 0.15,
              1e-6);
}

TEST(RewardTest, LateAFallIsPenalisedEvenWhereOtherPenaltiesLeaveNothing) {
  const RewardSettings r = shipped_settings();
  StepOutcome stands = obedient(1.0f, 0.0f, 0.0f);
  stands.power = 1e6f;
  StepOutcome fell = stands;
  fell.fell = true;
  const RewardSchedule late{.late = 1.0};
  EXPECT_NEAR(reward_of(stands, r, late).value - reward_of(fell, r, late).value,
              r.scale * r.unbounded_penalties.Fall::weight, 1e-5);
  EXPECT_EQ(reward_of(fell, r, {.late = 0.0}).value, 0.0f);  // early it would quicken the strides
}

TEST(RewardTest, PriorFadesToExactlyNothing) {
  const RewardSettings r = shipped_settings();
  EXPECT_EQ(schedule_at(r, 0.0, 0.0).prior, 1.0);
  EXPECT_EQ(schedule_at(r, r.prior_start_transitions, 0.0).prior, 1.0);
  EXPECT_GT(schedule_at(r, r.prior_end_transitions - 1e5, 0.0).prior, 0.0);
  EXPECT_EQ(schedule_at(r, r.prior_end_transitions, 0.0).prior, 0.0);
  EXPECT_EQ(schedule_at(r, 10.0 * r.prior_end_transitions, 0.0).prior, 0.0);
  // Whatever the feet do: the reward is the one without its two terms.
  RewardSettings without = r;
  without.rewards.Diagonality::weight = without.rewards.PairedSwing::weight = 0.0;
  StepOutcome s = obedient(1.0f, 0.0f, 0.0f);
  s.contact = {false, true, true, false};
  s.air_s = {0.1f, 0.0f, 0.0f, 0.1f};
  const auto value = [&](const RewardSettings& settings, double transitions) {
    return reward_of(s, settings, schedule_at(settings, transitions, 0.0)).value;
  };
  EXPECT_GT(value(r, 0.0), value(without, 0.0));
  EXPECT_EQ(value(r, r.prior_end_transitions), value(without, r.prior_end_transitions));
}

TEST(RewardTest, PenaltiesOnEnergyHeaveAndALowBodyRiseLate) {
  const RewardSettings r = shipped_settings();
  StepOutcome s = obedient(1.0f, 0.0f, 0.0f);
  s.power = 100.0f;
  s.vz = 0.2f;
  s.body_height = 0.46f;
  const RewardSchedule before = schedule_at(r, 1e12, 0.0);
  const RewardSchedule after = schedule_at(r, 1e12, 1.0);
  const penalty::Energy& energy = r.penalties;
  EXPECT_NEAR(energy.value(s, after) / energy.value(s, before), energy.late_factor, 1e-9);
  const penalty::BaseVertical& heave = r.penalties;
  EXPECT_NEAR(heave.value(s, after) / heave.value(s, before), heave.late_factor, 1e-9);
  const penalty::Height& height = r.penalties;
  EXPECT_GT(height.value(s, after), height.value(s, before));
}

TEST(RewardTest, TermsAddUpToTheRewardBeforeItsScale) {
  const RewardSettings r = shipped_settings();
  StepOutcome s = obedient(1.0f, 0.2f, 0.5f);
  s.power = 100.0f;
  s.vz = 0.1f;
  s.contact[2] = false;
  s.foot_speed[2] = 1.0f;
  s.action[3] = 0.4f;
  s.fell = true;
  const Reward earned = reward_of(s, r, {.penalty = 0.7, .late = 0.5});
  double sum = 0.0;
  for (const double term : earned.terms) sum += term;
  EXPECT_NEAR(earned.value, r.scale * sum, 1e-6);
  EXPECT_GT(earned.terms[0], 0.0);
  EXPECT_LT(earned.terms[Rewards::kTerms], 0.0);
}

TEST(RewardTest, EveryTermHasANameOfItsOwn) {
  const std::vector<std::string> names = reward_term_names();
  EXPECT_EQ(names.size(), kRewardTerms);
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), kRewardTerms);
}

}  // namespace
}  // namespace sandrunner::train
