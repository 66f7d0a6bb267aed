// SPDX-License-Identifier: BSD-3-Clause
// The program sandrunner-evaluate, as a user runs it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>

#include "tests/policy/random_policy.h"
#include "tests/support/program_test.h"
#include "tests/support/small_robot.h"

namespace sandrunner {
namespace {

class EvaluateCommandTest : public ProgramTest {
 protected:
  EvaluateCommandTest() : ProgramTest(SANDRUNNER_EVALUATE_PROGRAM) {
    write_policy_file(folder_.path("p"), random_policy_file());
  }
  void write_model(const std::string& name, const std::string& actor) const {
    write_policy_file(
        folder_.path(name),
        random_policy_file(1, {EncoderKind::kLstm, parse_actor_inputs("actor", actor)}));
  }
  std::string read(const std::string& name) const { return read_file(folder_.path(name)); }
};

TEST_F(EvaluateCommandTest, WritesAllFilesTheSameForAnyThreads) {
  write_policy_file(folder_.path("q"), random_policy_file(2));
  const std::string common = "--policy p --against q --runs 1 --grid-runs 1 ";
  ASSERT_EQ(run(common + "--threads 1 --out one"), 0) << error();
  EXPECT_TRUE(std::regex_match(error(), std::regex("(\\S+ \\S+/[pq]: [0-9]+ runs\n){12}")))
      << error();
  ASSERT_EQ(run(common + "--threads 3 --out three"), 0) << error();
  for (const char* name : {"evaluation.json", "straight.csv", "grid.csv", "turn.csv", "robust.csv",
                           "beyond.csv", "commands.csv"}) {
    const std::string file = read(std::string("one/") + name);
    EXPECT_GT(file.size(), 100u) << name;
    EXPECT_EQ(file, read(std::string("three/") + name)) << name;
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path("one")), {}), 7);

  const auto json = nlohmann::json::parse(read("one/evaluation.json"));
  EXPECT_EQ(json["settings"]["robot"], "raibo");
  EXPECT_EQ(json["policies"].size(), 2u);
  EXPECT_NE(json["policies"][0]["name"], json["policies"][1]["name"]);
  const auto& policy = json["policies"][1];
  EXPECT_EQ(policy["straight"].size(), 6u * 8u);
  EXPECT_EQ(policy["grid"].size(), 100u);
  EXPECT_EQ(policy["grid"][99]["sigma_cone_npm3"], 0.6e6);
  EXPECT_EQ(policy["turn"].size(), 20u);
  EXPECT_EQ(policy["envelope"]["forward_mps"], random_policy_file().spec.envelope.forward_mps);
  const auto& survival = policy["turn"][0]["survival"];
  EXPECT_EQ(survival["n"], 1);
  EXPECT_LE(survival["low"], survival["value"]);
  EXPECT_GE(survival["high"], survival["value"]);
}

TEST_F(EvaluateCommandTest, WritesOnlyThePartsAskedFor) {
  ASSERT_EQ(run("--policy p --only turn --runs 1 --grid-runs 1 --out dir"), 0) << error();
  EXPECT_TRUE(std::filesystem::exists(folder_.path("dir/turn.csv")));
  EXPECT_FALSE(std::filesystem::exists(folder_.path("dir/grid.csv")));
  EXPECT_NE(output().find("sideways"), std::string::npos);
}

TEST_F(EvaluateCommandTest, MeasuresAStudyModelThatSeesWhatSensorsMeasure) {
  write_model("s", "encoding, proprioception");
  ASSERT_EQ(run("--policy s --against p --only turn --runs 1 --threads 1 --out one"), 0) << error();
  ASSERT_EQ(run("--policy s --against p --only turn --runs 1 --threads 3 --out three"), 0);
  EXPECT_EQ(read("one/turn.csv"), read("three/turn.csv"));
}

TEST_F(EvaluateCommandTest, RefusesAStudyModelThatSeesTheGround) {
  write_model("s", "estimate, proprioception, terrain");
  EXPECT_EQ(run("--policy s --only turn"), 2);
  EXPECT_NE(error().find("needs what no robot can sense (encoder lstm, actor sees estimate, "
                         "proprioception, terrain)"),
            std::string::npos)
      << error();
}

TEST_F(EvaluateCommandTest, RefusesBadInputInOneLine) {
  write_file(folder_.path("broken"), "no policy");
  write_small_robot(folder_);
  const std::pair<const char*, const char*> cases[] = {
      {"", "--policy"},
      {"--policy absent", "absent"},
      {"--policy broken", "broken"},
      {"--policy p --against absent", "absent"},
      {"--policy p --robot absent", "absent"},
      {"--policy p --robot small.toml", "policy 'random' is for another robot"},
      {"--policy p --runs 0", "--runs: found 0, expected 1 to 100000"},
      {"--policy p --grid-runs -3", "--grid-runs: found -3, expected 1 to 100000"},
      {"--policy p --threads 0", "--threads: found 0, expected 1 to 1024"},
      {"--policy p --seed 0", "--seed: found 0, expected 1 to 1000000000"},
      {"--policy p --runs many", "--runs"},
      {"--policy p --only turn,jump", "'jump'"},
      {"--policy p --torque-speed-line perhaps", "'perhaps'"},
      {"--policy p --out p", "--out: 'p' is a file"},
      {"--policy p --unknown", "--unknown"},
  };
  for (const auto& [arguments, cause] : cases) expect_refused(arguments, cause);
}

}  // namespace
}  // namespace sandrunner
