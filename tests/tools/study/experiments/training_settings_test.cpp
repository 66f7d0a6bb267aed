// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/experiments/training_settings.h"

#include <gtest/gtest.h>

#include "tools/train/task/robot_settings.h"

namespace sandrunner::study {
namespace {

class TrainingSettingsTest : public testing::Test {
 protected:
  /// The settings of a training with these changes.
  std::string config(const std::vector<std::string>& changes) const {
    ConfigTree settings;
    train::add_training_layers(settings, robot_);
    for (const std::string& change : changes) settings.set(change);
    train::read_task_config(settings);
    return settings.effective();
  }
  const sim::Robot robot_ = sim::load_raibo();
};

TEST_F(TrainingSettingsTest, OfTheTrainersOwnSettingsNoneDiffers) {
  EXPECT_TRUE(settings_that_differ(config({}), robot_).empty());
}

TEST_F(TrainingSettingsTest, NumbersFlagsTextsAndArraysDiffer) {
  const auto found =
      settings_that_differ(config({"ground.rigid_envs=64", "robot.torque_speed_line=false",
                                   "ground.yielding=linear", "robot.latency_s=[0.0, 0.0, 0.01]"}),
                           robot_);
  std::string text;
  for (const SettingDifference& d : found) text += d.key + ": " + d.usual + ", " + d.value + "\n";
  EXPECT_EQ(text,
            "ground.rigid_envs: 16.0, 64.0\nground.yielding: \"granular\", \"linear\"\n"
            "robot.latency_s: [0.0, 0.005, 0.01], [0.0, 0.0, 0.01]\n"
            "robot.torque_speed_line: true, false\n");
}

TEST_F(TrainingSettingsTest, TheLengthIsNoDifferenceAndAPathLosesItsFolders) {
  const auto found = settings_that_differ(
      "run.transitions = 5.0\nimitation.teacher = \"/home/a/teacher-gm-1.safetensors\"\n"
      "ground.of_old = 3.0\n",
      robot_);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].key, "ground.of_old");
  EXPECT_EQ(found[0].usual, "");
  EXPECT_EQ(found[1].value, "\"teacher-gm-1.safetensors\"");
  EXPECT_EQ(found[1].usual, "\"\"");
}

TEST_F(TrainingSettingsTest, ASettingThatIsATableByNowIsNoUsualOne) {
  const auto found = settings_that_differ("reward.velocity = 3.0\n", robot_);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].value, "3.0");
  EXPECT_EQ(found[0].usual, "");
}

TEST_F(TrainingSettingsTest, TheLengthIsInTheProvenance) {
  train::TaskNetwork network{{}, {}, train::model_layout({}), {}};
  EXPECT_EQ(training_length({find_controller("ours"), 1, 0, network, std::nullopt}), 0.0);
  network.spec.provenance = {{"config", "run.transitions = 60000000.0\n"}};
  EXPECT_EQ(training_length({find_controller("ours"), 1, 0, network, std::nullopt}), 60e6);
}

}  // namespace
}  // namespace sandrunner::study
