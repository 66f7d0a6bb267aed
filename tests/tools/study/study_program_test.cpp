// SPDX-License-Identifier: BSD-3-Clause
// The program sandrunner-study, as a user runs it.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "policy/policy_file.h"
#include "tests/support/program_test.h"
#include "tests/tools/study/random_model.h"

namespace sandrunner {
namespace {

class StudyProgramTest : public ProgramTest {
 protected:
  StudyProgramTest() : ProgramTest(SANDRUNNER_STUDY_PROGRAM) {
    std::filesystem::create_directory(folder_.path("models"));
    put("ours-1");
    put("env-rigid-1");
  }
  void put(const std::string& name) const {
    write_file(folder_.path("models/" + name + ".safetensors"), shipped_policy_text());
  }
  std::string read(const std::string& name) const { return read_file(folder_.path(name)); }
  /// Starts the program with --out killed, and kills it once there is this file.
  void kill_after(const std::string& file, const std::vector<std::string>& options) const {
    std::vector<std::string> command = {SANDRUNNER_STUDY_PROGRAM, "--from", "models", "--out",
                                        "killed"};
    command.insert(command.end(), options.begin(), options.end());
    {
      ChildProcess killed(command, {.folder = folder_.path("")});
      const std::string first = folder_.path(file);
      for (int i = 0; i < 6000 && !std::filesystem::exists(first); ++i) usleep(10'000);
      ASSERT_TRUE(std::filesystem::exists(first));
    }  // SIGKILL
    ASSERT_FALSE(std::filesystem::exists(folder_.path("killed/report.html")));
  }
  /// These files of the folders `whole` and `killed` have the same bytes.
  void expect_as_whole(const std::vector<std::string>& names) const {
    for (const std::string& name : names)
      EXPECT_EQ(read("whole/" + name), read("killed/" + name)) << name;
  }
};

TEST_F(StudyProgramTest, WritesThePageAndItsNumbersTheSameForAnyThreads) {
  const std::string common = "--from models --only E1,E5 --runs 1 ";
  ASSERT_EQ(run(common + "--threads 1 --out one"), 0) << error();
  ASSERT_EQ(run(common + "--threads 2 --out two"), 0) << error();
  for (const std::string& name : files_in("one")) {
    if (std::filesystem::is_directory(folder_.path("one/" + name))) continue;
    EXPECT_EQ(read("one/" + name), read("two/" + name)) << name;
  }
  const auto json = nlohmann::json::parse(read("one/results.json"));
  for (const char* controller : {"ours", "env-rigid"}) {
    std::set<double> commands;
    for (const auto& group : json["experiments"]["E1"][controller]["1"]) {
      if (group["scenario"] == "") commands.insert(group["command"].get<double>());
    }
    EXPECT_EQ(commands.size(), 8u) << controller;
  }
  const std::string page = read("one/report.html");
  EXPECT_LT(page.size(), 4'000'000u);
  EXPECT_EQ(page.find("src=\"http"), std::string::npos);
  EXPECT_EQ(page.find("href=\"http"), std::string::npos);
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_NE(page.find("<code>sandrunner-study --from models --only E1,E5 --runs 1 "),
            std::string::npos);
  EXPECT_NE(page.find("<a href=\"#s3\">E1: Dry sand</a>"), std::string::npos);
  EXPECT_NE(page.find("<h2 id=\"s3\">E1: Dry sand"), std::string::npos);
  EXPECT_NE(page.find(">Not run: E2 (Recovery and transition), E3 "), std::string::npos);
  EXPECT_EQ(page.find("<h2 id=\"s5\">E2"), std::string::npos);
  EXPECT_GT(page.find("<details><summary>"), page.find("<h2 id=\"s4\">E5"));  // verdicts last
  EXPECT_NE(page.find("Not run: PL/Env-GM, PL/Env-Rigid"), std::string::npos);
}

TEST_F(StudyProgramTest, ThePublishedNetworkIsShownAndHasNoPartInTheVerdicts) {
  write_file(folder_.path("published.safetensors"), shipped_policy_text());
  const std::string common = "--from models --only E5 --runs 1 ";
  ASSERT_EQ(run(common + "--out without"), 0) << error();
  ASSERT_EQ(run(common + "--published published.safetensors --out with"), 0) << error();
  EXPECT_EQ(read("with/claims.csv"), read("without/claims.csv"));
  const std::string ran = "Run: Ours (1 seed), Env-Rigid (1 seed), Authors' network.";
  EXPECT_EQ(read("without/report.html").find(ran), std::string::npos);
  EXPECT_NE(read("with/report.html").find(ran), std::string::npos);
  const auto json = nlohmann::json::parse(read("with/results.json"));
  EXPECT_EQ(json["experiments"]["E5"]["published"].size(), 1u);
  EXPECT_FALSE(json["experiments"]["fairness"].contains("published"));
}

TEST_F(StudyProgramTest, ShowsWhatTheOraclesDependOnAndGoesOnWithTheSameBytes) {
  std::filesystem::create_directory(folder_.path("oracles"));
  write_random_model(folder_.path("oracles/oracle-h-1.safetensors"), "encoding, estimate, terrain");
  write_random_model(folder_.path("oracles/oracle-o-1.safetensors"),
                     "estimate, proprioception, terrain");
  const std::string common = "--from oracles --only E8 --runs 1 --grid-runs 1 ";
  ASSERT_EQ(run(common + "--threads 1 --out whole"), 0) << error();
  const std::string page = read("whole/report.html");
  EXPECT_NE(page.find("Run: Oracle(H) (1 seed), Oracle(O) (1 seed)."), std::string::npos);
  EXPECT_NE(page.find("alt=\"What the oracles' actions"), std::string::npos);
  // A run that was killed leaves what was done until then.
  std::filesystem::create_directories(folder_.path("killed/cache"));
  for (const char* name : {"fairness-oracle-h-1", "fairness-oracle-o-1", "E8-oracle-h-1"}) {
    const std::string file = std::string("/cache/") + name + ".json";
    std::filesystem::copy(folder_.path("whole" + file), folder_.path("killed" + file));
  }
  ASSERT_EQ(run(common + "--threads 2 --out killed"), 0) << error();
  EXPECT_NE(output().find("E8: 1 models run, 1 taken"), std::string::npos) << output();
  expect_as_whole({"report.html", "results.json", "claims.csv", "figures/fig4g.png"});
}

TEST_F(StudyProgramTest, AGridThatIsKilledGoesOnAndEndsInTheSameBytesForAnyThreads) {
  write_random_model(folder_.path("models/oracle-h-1.safetensors"), "encoding, estimate, terrain");
  const std::string common =
      "--from models --only E7 --runs 1 --grid-runs 16 --grid-cells 2 --threads ";
  ASSERT_EQ(run(common + "1 --out whole"), 0) << error();
  ASSERT_NO_FATAL_FAILURE(
      kill_after("killed/cache/E7-ours-1.json",
                 {"--only", "E7", "--runs", "1", "--grid-runs", "16", "--grid-cells", "2"}));
  ASSERT_EQ(run(common + "2 --out killed"), 0) << error();
  EXPECT_NE(output().find("fairness: 0 models run, 3 taken"), std::string::npos) << output();
  EXPECT_EQ(output().find("E7: 3 models run"), std::string::npos) << output();
  expect_as_whole({"report.html", "results.json", "claims.csv", "figures/fig4ad.png",
                   "figures/fig4_lines.png"});
  const std::string page = read("whole/report.html");
  EXPECT_NE(page.find("16 robots in each of 4 cells"), std::string::npos);
  EXPECT_NE(page.find("The paper: &quot;tested 360 times"), std::string::npos);
  const auto json = nlohmann::json::parse(read("whole/results.json"));
  for (const char* controller : {"ours", "env-rigid", "oracle-h"}) {
    EXPECT_EQ(json["experiments"]["E7"][controller]["1"][0]["lists"]["reward"].size(), 4u);
  }
}

TEST_F(StudyProgramTest, AnotherNumberOfRobotsRunsTheGridAgain) {
  const std::string common = "--from models --only E7 --runs 1 --grid-cells 2 --out dir ";
  ASSERT_EQ(run(common + "--grid-runs 2"), 0) << error();
  ASSERT_EQ(run(common + "--grid-runs 3"), 0) << error();
  EXPECT_NE(output().find("fairness: 0 models run, 2 taken"), std::string::npos) << output();
  EXPECT_NE(output().find("E7: 2 models run, 0 taken"), std::string::npos) << output();
}

TEST_F(StudyProgramTest, KeepsWhatIsDoneAndTakesADamagedOrAnOldFileAgain) {
  const std::string line = "--from models --only E6 --runs 1 --out dir";
  ASSERT_EQ(run(line), 0) << error();
  const std::string before = read("dir/results.json");
  write_file(folder_.path("dir/cache/E6-ours-1.json"), "{\"key\": ");
  ASSERT_EQ(run(line), 0) << error();
  EXPECT_NE(output().find("E6: 1 models run, 1 taken"), std::string::npos) << output();
  EXPECT_EQ(read("dir/results.json"), before);
  // And one of another version.
  std::string measured = read("dir/cache/E6-ours-1.json");
  const std::string key = "{\"key\":\"version ";
  ASSERT_TRUE(measured.starts_with(key)) << measured.substr(0, 60);
  write_file(folder_.path("dir/cache/E6-ours-1.json"), measured.insert(key.size(), "9"));
  write_file(folder_.path("dir/cache/E6-env-rigid-1.json"), "{\"key\": 5}");
  ASSERT_EQ(run(line), 0) << error();
  EXPECT_NE(output().find("E6: 2 models run, 0 taken"), std::string::npos) << output();
}

TEST_F(StudyProgramTest, SaysWhereThePageCannotBeWrittenAndKeepsTheResults) {
  std::filesystem::create_directories(folder_.path("dir/report.html"));
  ASSERT_EQ(run("--from models --only E6 --runs 1 --out dir"), 2);
  EXPECT_EQ(std::count(error().begin(), error().end(), '\n'), 1) << error();
  EXPECT_TRUE(error().starts_with("sandrunner-study: ")) << error();
  EXPECT_NE(error().find("report.html"), std::string::npos) << error();
  EXPECT_TRUE(std::filesystem::exists(folder_.path("dir/results.json")));
}

TEST_F(StudyProgramTest, RefusesBadInputInOneLine) {
  std::filesystem::create_directory(folder_.path("broken"));
  write_file(folder_.path("broken/ours-1.safetensors"), "no policy");
  write_file(folder_.path("other.json"), "{}");
  const std::pair<const char*, const char*> cases[] = {
      {"--from models", "--out"},
      {"--out dir", "--from"},
      {"--from absent --out dir", "--from: found no folder 'absent'"},
      {"--from broken --out dir", "ours-1.safetensors"},
      {"--from models --out models/ours-1.safetensors", "--out"},
      {"--from models --out dir --only E99", "--only: found 'E99'"},
      {"--from models --out dir --runs 0", "--runs: found 0"},
      {"--from models --out dir --grid-runs 0", "--grid-runs: found 0"},
      {"--from models --out dir --grid-cells 1", "--grid-cells: found 1"},
      {"--from models --out dir --seeds 7", "--from: found no trained controller"},
      {"--from models --out dir --contact other.json", "--contact other.json"},
  };
  for (const auto& [arguments, cause] : cases) expect_refused(arguments, cause);
}

}  // namespace
}  // namespace sandrunner
