// SPDX-License-Identifier: BSD-3-Clause
// The trainings of the study: what each changes, and the script that runs them.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include "rt/base/output_files.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"
#include "tools/study/experiments/controllers.h"
#include "tools/train/task/robot_settings.h"
#include "tools/train/train_config.h"

namespace sandrunner::train {
namespace {

const std::string kStudy = SANDRUNNER_STUDY_FOLDER;
const std::string kWindows = " --set learner.window=128 --set run.envs=256";  // of all trainings

/// All settings of a training by their key.
std::map<std::string, std::string> settings_of(const std::string& file) {
  ConfigTree tree;
  add_training_layers(tree, sim::load_raibo());
  if (!file.empty()) tree.add_file(file);
  std::istringstream lines(read_train_config(tree).effective);
  std::map<std::string, std::string> settings;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t equals = line.find(" = ");
    settings[line.substr(0, equals)] = line.substr(equals + 3);
  }
  return settings;
}

std::string wiring_of(const std::map<std::string, std::string>& settings) {
  const auto text = [&](const char* key) {
    const std::string& quoted = settings.at(key);
    return quoted.substr(1, quoted.size() - 2);
  };
  return wiring_text({parse_encoder("encoder", text("network.encoder")),
                      parse_actor_inputs("actor", text("network.actor"))});
}

TEST(TrainingsTest, EachDiffersFromTheBuiltInSettingsAsListedAndIsWiredAsItsController) {
  const std::map<std::string, std::string> rigid = {{"ground.rigid_envs", "64"},
                                                    {"ground.patchy_envs", "0"},
                                                    {"ground.rigid_uneven_share", "1.0"},
                                                    {"ground.roughness_m", "0.05"}};
  std::map<std::string, std::map<std::string, std::string>> expected = {
      {"ours", {}},
      {"env-rigid", rigid},
      {"env-quasistatic", {{"ground.inertial_high", "0.0"}}},  // the low end is 0 anyway
      {"env-linear", {{"ground.yielding", "\"linear\""}}},
      {"tcn", {{"network.encoder", "\"tcn\""}}},
      {"oracle-h", {{"network.actor", "\"encoding, estimate, terrain\""}}},
      {"oracle-o", {{"network.actor", "\"estimate, proprioception, terrain\""}}},
      {"teacher-gm",
       {{"network.encoder", "\"insight\""},
        {"network.actor", "\"encoding, proprioception\""},
        {"learner.estimate_weight", "0.0"}}},
      {"teacher-rigid",
       {{"network.encoder", "\"insight\""},
        {"network.actor", "\"encoding, proprioception\""},
        {"learner.estimate_weight", "0.0"}}},
  };
  expected["teacher-rigid"].insert(rigid.begin(), rigid.end());
  for (const auto& [name, more] :
       {std::pair<std::string, std::map<std::string, std::string>>{"pl-gm", {}},
        {"pl-rigid", rigid}}) {
    auto& student = expected[name] = more;
    student.insert({{"network.actor", "\"encoding, proprioception\""},
                    {"learner.estimate_weight", "0.0"},
                    {"learner.action_std_start", "0.05"},
                    {"learner.action_std_min", "0.05"},
                    {"learner.learning_rate_min", "0.0005"},
                    {"learner.learning_rate_max", "0.0005"},
                    {"command.speed_start_mps", "4.0"},
                    {"ground.sigma_flat_low_start", "1000000.0"},
                    {"ground.sigma_cone_low_start", "150000.0"}});
  }
  const auto built_in = settings_of("");
  std::set<std::string> found;
  for (const auto& file : std::filesystem::directory_iterator(kStudy + "/trainings")) {
    const std::string name = file.path().stem();
    found.insert(name);
    const auto settings = settings_of(file.path());
    std::map<std::string, std::string> changed;
    for (const auto& [key, value] : settings) {
      if (built_in.at(key) != value) changed[key] = value;
    }
    ASSERT_TRUE(expected.contains(name)) << name;
    EXPECT_EQ(changed, expected.at(name)) << name;
    EXPECT_EQ(wiring_of(settings), study::find_controller(name)->wiring) << name;
  }
  EXPECT_EQ(found.size(), expected.size());
}

class TrainScriptTest : public testing::Test {
 protected:
  /// The script with a trainer that writes down its arguments and the files of a training of
  /// `rows` updates.
  Ended run(int rows, const std::vector<std::string>& arguments,
            const std::string& threads = "") const {
    const std::string trainer = folder_.path("trainer");
    write_file(trainer,
               "#!/bin/sh\necho \"$@\" >> \"$LOG\"\n"
               "while [ \"$1\" != --out ]; do shift; done\nmkdir -p \"$2\"\n"
               "echo weights > \"$2/policy.safetensors\"; echo early > \"$2/best.safetensors\"; "
               "touch \"$2/checkpoint.bin\"\n"
               "{ echo iteration,transitions,core_hours,reward,battery_alive,battery_error,"
               "battery_cost_of_transport,command_speed_mps,ground_open\n"
               "for i in $(seq $ROWS); do echo $i,$((i * 10)),1,2,3,4,5,6,7; done; } "
               "> \"$2/curve.csv\"\n");
    std::filesystem::permissions(trainer, std::filesystem::perms::owner_all);
    std::vector<std::string> words = {"env",
                                      "SANDRUNNER_TRAIN=" + trainer,
                                      "LOG=" + folder_.path("log"),
                                      "ROWS=" + std::to_string(rows),
                                      "TRANSITIONS=300",
                                      "THREADS=" + threads,
                                      kStudy + "/train.sh"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return run_process(words);
  }
  const TemporaryFolder folder_;
};

TEST_F(TrainScriptTest, TrainsContinuesAndKeepsThePolicyOfTheEndWithAShortCurve) {
  const std::string out = folder_.path("out");
  const Ended interrupted = run(29, {out, "2", "env-rigid"});
  EXPECT_EQ(interrupted.code, 1) << interrupted;
  EXPECT_NE(interrupted.err.find("env-rigid-2 is not complete"), std::string::npos) << interrupted;
  EXPECT_FALSE(std::filesystem::exists(out + "/env-rigid-2.safetensors"));
  const Ended complete = run(30, {out, "2", "env-rigid", "ours"});
  EXPECT_EQ(complete.code, 0) << complete;
  EXPECT_EQ(read_file(out + "/env-rigid-2.safetensors"), "weights\n");
  EXPECT_EQ(read_file(out + "/ours-2.csv"),
            "transitions,core_hours,reward,battery_alive,battery_error,battery_cost_of_transport,"
            "command_speed_mps,ground_open\n10,1,2,3,4,5,6,7\n210,1,2,3,4,5,6,7\n"
            "300,1,2,3,4,5,6,7\n");
  const auto line = [&](const std::string& name, const std::string& more) {
    return "--config " + kStudy + "/trainings/" + name + ".toml" + kWindows +
           " --set run.transitions=300 --seed 2 --out " + out + "/" + name + "-2" + more + "\n";
  };
  EXPECT_EQ(read_file(folder_.path("log")),
            line("env-rigid", "") + line("env-rigid", " --resume") + line("ours", ""));
}

TEST_F(TrainScriptTest, ATeacherHasThreeFifthsOfTheLengthAndItsStudentTheOtherTwo) {
  const std::string out = folder_.path("out");
  const Ended without = run(20, {out, "2", "pl-gm"});
  EXPECT_EQ(without.code, 2);
  EXPECT_NE(without.err.find("expected that of teacher-gm: train it first"), std::string::npos)
      << without;
  EXPECT_EQ(run(18, {out, "2", "teacher-gm"}).code, 0);
  const Ended ended = run(20, {out, "2", "pl-gm"});
  EXPECT_EQ(ended.code, 0) << ended;
  EXPECT_EQ(read_file(folder_.path("log")),
            "--config " + kStudy + "/trainings/teacher-gm.toml" + kWindows +
                " --set run.transitions=180 --seed 2 --out " + out + "/teacher-gm-2\n--config " +
                kStudy + "/trainings/pl-gm.toml" + kWindows +
                " --set run.transitions=120 --set "
                "imitation.teacher=" +
                out + "/teacher-gm-2.safetensors --seed 2 --out " + out + "/pl-gm-2\n");
}

TEST_F(TrainScriptTest, PassesTheNumberOfThreadsOn) {
  EXPECT_EQ(run(30, {folder_.path("out"), "1", "tcn"}, "1").code, 0);
  EXPECT_NE(read_file(folder_.path("log")).find("--seed 1 --threads 1 --out"), std::string::npos);
}

TEST_F(TrainScriptTest, RefusesAnUnknownNameBeforeItTrains) {
  const Ended ended = run(30, {folder_.path("out"), "1", "ours", "env-sand"});
  EXPECT_EQ(ended.code, 2);
  EXPECT_NE(ended.err.find("found 'env-sand', expected one of env-linear.toml"), std::string::npos)
      << ended;
  EXPECT_FALSE(std::filesystem::exists(folder_.path("out")));
}

}  // namespace
}  // namespace sandrunner::train
