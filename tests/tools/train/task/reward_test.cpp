// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/task/reward.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "tests/tools/train/task/shipped_config.h"

namespace sandrunner::train {
namespace {

RewardSettings shipped_settings() { return shipped_task_config(sim::load_raibo()).reward; }

// A robot in its nominal posture that does exactly what it is asked for.
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

double paid(const StepOutcome& s, const RewardSettings& r) {
  std::array<double, kRewardTerms> terms;
  return sum_of(kPaid, s, r, {}, terms.data());
}

double energy_cost(StepOutcome s) {
  s.power = 100.0f;
  return energy_charged(s, shipped_settings(), {});
}

TEST(RewardTest, StandingWhenToldToGoEarnsLessThanHalfOfGoing) {
  const RewardSettings r = shipped_settings();
  StepOutcome standing = obedient(0.0f, 0.0f, 0.0f);
  standing.command = {1.0f, 0.0f, 0.0f};
  EXPECT_LT(paid(standing, r), 0.5 * paid(obedient(1.0f, 0.0f, 0.0f), r));
}

/// Mean of what is paid over a stride in which the motion swings by a half about `share` of the
/// command, and its mean over 0.3 s by a twentieth.
double paid_over_a_stride(std::array<float, 3> command, double share) {
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
    sum += paid(s, shipped_settings());
  }
  return sum / kPhases;
}

TEST(RewardTest, MotionThatSwingsAboutTheCommandEarnsMostWithItsMeanAtTheCommand) {
  for (const std::array<float, 3> command :
       {std::array{0.5f, 0.0f, 0.0f}, {0.0f, 0.5f, 0.0f}, {0.0f, 0.0f, 0.5f}, {2.0f, 0.0f, 0.0f}}) {
    const double at = paid_over_a_stride(command, 1.0);
    EXPECT_GT(at, paid_over_a_stride(command, 1.04)) << command[0] << command[1] << command[2];
    EXPECT_GT(at, paid_over_a_stride(command, 0.96)) << command[0] << command[1] << command[2];
  }
}

TEST(RewardTest, EnergyIsChargedPerDistanceAndNotPerTime) {
  const RewardSettings r = shipped_settings();
  EXPECT_NEAR(energy_cost(obedient(1.0f, 0.0f, 0.0f)) / energy_cost(obedient(3.0f, 0.0f, 0.0f)),
              (r.energy_offset_mps + 3.0) / (r.energy_offset_mps + 1.0), 1e-9);
}

TEST(RewardTest, EnergyIsSharedByDoubleTheWaySidewaysOrBackwardsAndByTurns) {
  const double ahead = energy_cost(obedient(1.0f, 0.0f, 0.0f));
  EXPECT_NEAR(energy_cost(obedient(-0.5f, 0.0f, 0.0f)), ahead, 1e-9);
  EXPECT_NEAR(energy_cost(obedient(0.0f, 0.5f, 0.0f)), ahead, 1e-9);
  EXPECT_NEAR(energy_cost(obedient(0.0f, -0.5f, 0.0f)), ahead, 1e-9);
  EXPECT_NEAR(energy_cost(obedient(0.0f, 0.0f, 2.0f)), ahead, 1e-9);
  EXPECT_NEAR(energy_cost(obedient(0.0f, 0.0f, -2.0f)), ahead, 1e-9);
}

TEST(RewardTest, DriftCostsMuchMoreThanTheSwingOfTheGait) {
  const RewardSettings r = shipped_settings();
  const StepOutcome straight = obedient(1.0f, 0.0f, 0.0f);
  StepOutcome swinging = straight, drifting = straight;
  swinging.vy = drifting.vy = 0.1f;
  drifting.drift[1] = 0.1f;
  EXPECT_LT(paid(drifting, r), paid(swinging, r) - 0.3);
}

TEST(RewardTest, CostsGrowWithTheirRampAndPricesMakeARewardNegativeOnlyLate) {
  const RewardSettings r = shipped_settings();
  StepOutcome s = obedient(1.0f, 0.0f, 0.0f);
  s.power = 200.0f;
  const float early = reward(s, r, {.all = 0.1}).value;
  const float all = reward(s, r, {.all = 1.0}).value;
  const float dear = reward(s, r, {.all = 1.0, .late = 1.0}).value;
  EXPECT_GT(early, all);
  EXPECT_GT(all, dear);
  s.power = 1e6f;
  EXPECT_EQ(reward(s, r, {}).value, 0.0f);
  const float bottomless = reward(s, r, {.late = 1.0}).value;
  EXPECT_LT(bottomless, static_cast<float>(-r.scale * r.debt));
  EXPECT_LT(-bottomless, r.scale * r.fall / 10.0);
  EXPECT_LT(kPolicyHz * r.debt, r.fall);
}

TEST(RewardTest, BelowTheDebtASumCountsEverLessButCounts) {
  EXPECT_EQ(bounded(0.7, 0.6), 0.7);
  EXPECT_EQ(bounded(-0.6, 0.6), -0.6);
  EXPECT_NEAR(bounded(-0.6 - 1e-6, 0.6), -0.6 - 1e-6, 1e-11);  // no kink
  EXPECT_NEAR(bounded(-1.2, 0.6), -0.6 * (1.0 + std::log(2.0)), 1e-15);
  EXPECT_LT(bounded(-101.0, 0.6), bounded(-100.0, 0.6) - 1e-3);
  EXPECT_EQ(bounded(-100.0, 0.0), 0.0);
}

TEST(RewardTest, LateAStruckStopCostsByTheShareOfTheStep) {
  const RewardSettings r = shipped_settings();
  const StepOutcome free = obedient(1.0f, 0.0f, 0.0f);
  StepOutcome struck = free;
  struck.past_stop = 0.25f;
  const auto lost = [&](const CostRamp& ramp) {
    return reward(free, r, ramp).value - reward(struck, r, ramp).value;
  };
  EXPECT_EQ(lost({.late = 0.0}), 0.0f);
  EXPECT_NEAR(lost({.late = 1.0}), r.scale * 0.25 * r.joint_stop, 1e-6);
}

TEST(RewardTest, LateAShortStrideCostsByTheTimeThatItLacks) {
  RewardSettings r = shipped_settings();
  r.stride_shortest_s = 0.3;
  const StepOutcome none = obedient(1.0f, 0.0f, 0.0f);
  const auto lost = [&](std::array<float, kNumLegs> stride_s, const CostRamp& ramp) {
    StepOutcome s = none;
    s.stride_s = stride_s;
    return reward(none, r, ramp).value - reward(s, r, ramp).value;
  };
  const CostRamp late{.late = 1.0};
  EXPECT_EQ(lost({0.1f}, {.late = 0.0}), 0.0f);
  EXPECT_EQ(lost({0.3f, 0.4f}, late), 0.0f);
  EXPECT_NEAR(lost({0.2f, 0.0f, 0.25f}, late), r.scale * r.cost_weight * r.short_stride * 0.15,
              1e-6);
}

TEST(RewardTest, LateAFallCostsEvenWherePricesLeaveNothing) {
  const RewardSettings r = shipped_settings();
  StepOutcome stands = obedient(1.0f, 0.0f, 0.0f);
  stands.power = 1e6f;
  StepOutcome fell = stands;
  fell.fell = true;
  const CostRamp late{.late = 1.0};
  EXPECT_NEAR(reward(stands, r, late).value - reward(fell, r, late).value, r.scale * r.fall, 1e-5);
  EXPECT_EQ(reward(fell, r, {.late = 0.0}).value, 0.0f);  // early it would quicken the strides
}

TEST(RewardTest, PriorFadesToExactlyNothing) {
  const RewardSettings r = shipped_settings();
  EXPECT_EQ(cost_ramp_at(r, 0.0, 0.0).prior, 1.0);
  EXPECT_EQ(cost_ramp_at(r, r.prior_start_transitions, 0.0).prior, 1.0);
  EXPECT_GT(cost_ramp_at(r, r.prior_end_transitions - 1e5, 0.0).prior, 0.0);
  EXPECT_EQ(cost_ramp_at(r, r.prior_end_transitions, 0.0).prior, 0.0);
  EXPECT_EQ(cost_ramp_at(r, 10.0 * r.prior_end_transitions, 0.0).prior, 0.0);
  // Whatever the feet do: the reward is the one without its two terms.
  RewardSettings without = r;
  without.diagonality = without.paired_swing = 0.0;
  StepOutcome s = obedient(1.0f, 0.0f, 0.0f);
  s.contact = {false, true, true, false};
  s.air_s = {0.1f, 0.0f, 0.0f, 0.1f};
  const auto value = [&](const RewardSettings& settings, double transitions) {
    return reward(s, settings, cost_ramp_at(settings, transitions, 0.0)).value;
  };
  EXPECT_GT(value(r, 0.0), value(without, 0.0));
  EXPECT_EQ(value(r, r.prior_end_transitions), value(without, r.prior_end_transitions));
}

TEST(RewardTest, PricesOfEnergyHeaveAndALowBodyRiseLate) {
  const RewardSettings r = shipped_settings();
  StepOutcome s = obedient(1.0f, 0.0f, 0.0f);
  s.power = 100.0f;
  s.vz = 0.2f;
  s.body_height = 0.46f;
  const CostRamp before = cost_ramp_at(r, 1e12, 0.0);
  const CostRamp after = cost_ramp_at(r, 1e12, 1.0);
  EXPECT_NEAR(energy_charged(s, r, after) / energy_charged(s, r, before), r.energy_end, 1e-9);
  EXPECT_NEAR(base_vertical_charged(s, r, after) / base_vertical_charged(s, r, before),
              r.base_vertical_end, 1e-9);
  EXPECT_GT(height_charged(s, r, after), height_charged(s, r, before));
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
  const Reward earned = reward(s, r, {.all = 0.7, .late = 0.5});
  double sum = 0.0;
  for (const double term : earned.terms) sum += term;
  EXPECT_NEAR(earned.value, r.scale * sum, 1e-6);
  EXPECT_GT(earned.terms[0], 0.0);
  EXPECT_LT(earned.terms[std::size(kPaid)], 0.0);
}

TEST(RewardTest, EveryTermHasANameOfItsOwn) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < kRewardTerms; ++i) names.insert(reward_term_name(i));
  EXPECT_EQ(names.size(), kRewardTerms);
}

}  // namespace
}  // namespace sandrunner::train
