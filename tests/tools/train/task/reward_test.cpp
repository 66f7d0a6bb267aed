// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/task/reward.h"

#include <gtest/gtest.h>

#include "rt/base/config_tree.h"
#include "tools/train/embedded.h"

namespace sandrunner::train {
namespace {

RewardSettings shipped_settings() {
  ConfigTree tree;
  tree.add_text(embedded_train_file("raibo.toml"), "raibo.toml");
  return read_train_config(tree).reward;
}

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

double energy_cost(const StepOutcome& at_rest) {
  const RewardSettings r = shipped_settings();
  StepOutcome s = at_rest;
  s.power = 100.0f;
  return cost(s, r, 1.0) - cost(at_rest, r, 1.0);
}

TEST(RewardTest, WhoStandsWhenAskedToGoEarnsLessThanHalfOfWhoGoes) {
  const RewardSettings r = shipped_settings();
  StepOutcome standing = obedient(0.0f, 0.0f, 0.0f);
  standing.command = {1.0f, 0.0f, 0.0f};
  EXPECT_LT(positive_reward(standing, r), 0.5 * positive_reward(obedient(1.0f, 0.0f, 0.0f), r));
}

TEST(RewardTest, EnergyIsChargedByTheWayAndNotByTheTime) {
  const RewardSettings r = shipped_settings();
  EXPECT_NEAR(energy_cost(obedient(1.0f, 0.0f, 0.0f)) / energy_cost(obedient(3.0f, 0.0f, 0.0f)),
              (r.energy_offset_mps + 3.0) / (r.energy_offset_mps + 1.0), 1e-9);
}

TEST(RewardTest, AWaySidewaysOrBackwardsCountsDoubleAndATurnCounts) {
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
  EXPECT_LT(positive_reward(drifting, r), positive_reward(swinging, r) - 0.3);
}

TEST(RewardTest, CostsGrowWithTheirRampAndARewardIsNeverNegative) {
  const RewardSettings r = shipped_settings();
  StepOutcome s = obedient(1.0f, 0.0f, 0.0f);
  s.power = 200.0f;
  const float early = reward(s, r, {.all = 0.1});
  const float all = reward(s, r, {.all = 1.0});
  const float dear = reward(s, r, {.all = 1.0, .energy = 2.0});
  EXPECT_GT(early, all);
  EXPECT_GT(all, dear);
  s.power = 1e6f;
  EXPECT_EQ(reward(s, r, {}), 0.0f);
}

}  // namespace
}  // namespace sandrunner::train
