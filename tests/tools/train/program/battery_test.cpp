// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/battery.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "tools/train/task/robot_settings.h"
#include "tools/train/train_config.h"

namespace sandrunner::train {
namespace {

TrainConfig config_with(const std::vector<std::string>& assignments) {
  ConfigTree tree;
  add_training_layers(tree, sim::load_raibo());
  for (const std::string& assignment : assignments) tree.set(assignment);
  return read_train_config(tree);
}

// Runs of a second on hard ground, of a robot so stiff that it stands whatever a random network
// answers.
const std::vector<std::string> kBrief = {"battery.runs=2",
                                         "battery.duration_s=1",
                                         "ground.rigid_envs=64",
                                         "ground.patchy_envs=0",
                                         "policy.kp_nmprad=150",
                                         "policy.kd_nmsprad=3",
                                         "policy.action_scale_rad=0.1"};

struct Judge {
  explicit Judge(const std::vector<std::string>& assignments, int threads = 1)
      : config(config_with(assignments)),
        layout(config.learner.network, Task::privileged_size()),
        pool(threads),
        battery(config.battery, config.task, config.learner.block_envs, sim::load_raibo(), layout,
                pool) {}
  BatteryFigures figures(std::uint64_t seed) {
    return battery.run(learner::initial_parameters(layout, seed, 0.5));
  }

  TrainConfig config;
  learner::ParameterLayout layout;
  WorkerPool pool;
  Battery battery;
};

bool same_bits(const BatteryFigures& a, const BatteryFigures& b) {
  using Words = std::array<std::uint64_t, sizeof(BatteryFigures) / sizeof(std::uint64_t)>;
  return std::bit_cast<Words>(a) == std::bit_cast<Words>(b);
}

TEST(BatteryTest, GroundsAreThoseOfTheTraining) {
  EXPECT_EQ(Judge({}).battery.grounds(),
            (std::vector<std::string>{"rigid", "wet-sand", "grass", "dry-sand", "softest"}));
  EXPECT_EQ(Judge({"ground.rigid_envs=64", "ground.patchy_envs=0"}).battery.grounds(),
            std::vector<std::string>{"rigid"});
  EXPECT_EQ(Judge({"ground.rigid_envs=0", "ground.patchy_envs=64", "ground.patch_rigid_share=1"})
                .battery.grounds(),
            std::vector<std::string>{"rigid"});
  EXPECT_EQ(Judge({"ground.rigid_envs=0", "ground.patchy_envs=0", "ground.sigma_flat_low=3e6",
                   "ground.sigma_cone_low=0.3e6"})
                .battery.grounds(),
            (std::vector<std::string>{"wet-sand", "grass", "softest"}));
}

TEST(BatteryTest, GroundsOfATrainingOnSpringsAreSprings) {
  EXPECT_EQ(
      Judge({"ground.yielding=linear"}).battery.grounds(),
      (std::vector<std::string>{"rigid", "stiff-spring", "spring", "soft-spring", "softest"}));
}

TEST(BatteryTest, FiguresAreTheSameForAnyNumberOfThreadsAndEachTime) {
  Judge one(kBrief, 1), two(kBrief, 2);
  const BatteryFigures first = one.figures(1);
  EXPECT_FALSE(same_bits(one.figures(2), first));
  EXPECT_TRUE(same_bits(one.figures(1), first));
  EXPECT_TRUE(same_bits(two.figures(1), first));
}

TEST(BatteryTest, ARobotThatStandsStillSurvivesAndDoesNotTrack) {
  Judge judge(kBrief);
  const BatteryFigures f = judge.battery.run(std::vector<float>(judge.layout.size(), 0.0f));
  EXPECT_EQ(f.alive, 1.0);
  EXPECT_NEAR(f.error, 1.0, 0.1);
}

TEST(BatteryTest, ScoreIsSurvivalThenTrackingThenCost) {
  const BatterySettings s = config_with({}).battery;
  BatteryFigures good;
  good.alive = 1.0;
  good.error = s.tracked_error;
  good.cost_of_transport = 0.6;
  const double score = score_of(good, s, 1.0);
  const auto changed = [&](auto&& change) {
    BatteryFigures f = good;
    change(f);
    return score_of(f, s, 1.0);
  };
  // A fall or a command that is not tracked is worse than a high cost.
  const double costly = changed([](BatteryFigures& f) { f.cost_of_transport = 1.2; });
  EXPECT_LT(changed([](BatteryFigures& f) { f.alive = 1.0 - 3.0 / 225.0; }), costly);
  EXPECT_LT(changed([](BatteryFigures& f) { f.error += 0.02; }), costly);
  // Each cost counts; less error than is asked for does not.
  EXPECT_LT(costly, score);
  EXPECT_LT(changed([](BatteryFigures& f) { f.too_fast = 0.01; }), score);
  EXPECT_LT(changed([](BatteryFigures& f) { f.drift_mps = 0.05; }), score);
  EXPECT_LT(changed([](BatteryFigures& f) { f.yaw_drift_radps = 0.05; }), score);
  EXPECT_EQ(changed([](BatteryFigures& f) { f.error = 0.0; }), score);
  EXPECT_LT(score_of({}, s, 1.0), -900.0);  // nobody is left, and no cost is defined
}

// A training kept a policy of its first tenth, as none of the later and much better ones survived
// quite as many runs.
TEST(BatteryTest, OfPoliciesThatSurviveAlikeTheCheaperHasTheHigherScore) {
  const BatterySettings s = config_with({}).battery;
  BatteryFigures early, late;
  early.alive = 220.0 / 225.0;
  early.cost_of_transport = 0.78;
  late.alive = 218.0 / 225.0;
  late.cost_of_transport = 0.53;
  EXPECT_GT(score_of(late, s, early.alive), score_of(early, s, early.alive));
}

}  // namespace
}  // namespace sandrunner::train
