// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/page/methods.h"

#include <gtest/gtest.h>

#include "tools/train/task/robot_settings.h"

namespace sandrunner::study {
namespace {

class MethodsTest : public testing::Test {
 protected:
  /// The settings of a training with these changes.
  std::string config(const std::vector<std::string>& changes) const {
    ConfigTree settings;
    train::add_training_layers(settings, robot_);
    for (const std::string& change : changes) settings.set(change);
    train::read_task_config(settings);
    return settings.effective();
  }
  Model model(const char* key, int seed, const std::string& settings) const {
    train::TaskNetwork network{{}, {}, train::model_layout({}), {}};
    network.spec.provenance = {{"config", settings + "run.transitions = 60000000.0\n"},
                               {"seed", "7"},
                               {"processor", "a <chip>"}};
    return {find_controller(key), seed, 0, network, std::nullopt};
  }
  const sim::Robot robot_ = sim::load_raibo();
};

TEST_F(MethodsTest, OfTheTrainersOwnSettingsNoneDiffers) {
  EXPECT_TRUE(settings_that_differ(config({}), robot_).empty());
}

TEST_F(MethodsTest, NumbersFlagsTextsAndArraysDiffer) {
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

TEST_F(MethodsTest, TheLengthIsNoDifferenceAndAPathLosesItsFolders) {
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

TEST_F(MethodsTest, ASettingThatIsATableByNowIsNoUsualOne) {
  const auto found = settings_that_differ("reward.velocity = 3.0\n", robot_);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].value, "3.0");
  EXPECT_EQ(found[0].usual, "");
}

TEST_F(MethodsTest, TheTablesHaveEachSettingOnceWithItsSeeds) {
  const std::string html = methods_tables(
      {model("ours", 1, config({})), model("env-rigid", 1, config({"ground.rigid_envs=64"})),
       model("env-rigid", 2, config({"ground.rigid_envs=64"}))},
      robot_);
  EXPECT_NE(html.find("<td>Ours</td><td>none</td>"), std::string::npos) << html;
  EXPECT_NE(html.find("<td>Env-Rigid</td><td>ground.rigid_envs</td><td>64.0</td><td>16.0</td>"
                      "<td>1, 2</td>"),
            std::string::npos)
      << html;
  EXPECT_NE(html.find("<td>env-rigid-2</td><td>60</td><td>7</td>"), std::string::npos) << html;
  EXPECT_EQ(longest_training({model("ours", 1, "")}), 60e6);
  EXPECT_NE(html.find("a &lt;chip&gt;"), std::string::npos) << html;
}

}  // namespace
}  // namespace sandrunner::study
