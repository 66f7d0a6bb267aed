// SPDX-License-Identifier: BSD-3-Clause
// The program sandrunner-train, run as a user runs it, on a training of a few seconds.
#include "tests/tools/train/program/train_command.h"

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <sstream>
#include <string>

#include "rt/base/errors.h"

namespace sandrunner {
namespace {

TEST_F(TrainCommandTest, FiveKillsAndResumesEndInTheWeightsOfAnUninterruptedRun) {
  ASSERT_EQ(run("whole", {"--threads", "1"}), 0);
  std::vector<std::string> often = kOften;
  for (int kill = 0; kill < 5; ++kill) {
    CheckpointWatch watch(folder_.path("killed"));
    ChildProcess child(training("killed", often));
    if (kill == 0) often.push_back("--resume");
    EXPECT_TRUE(watch.wait_for(1 + kill % 3));
    child.signal(SIGKILL);
    EXPECT_EQ(child.wait().code, 128 + SIGKILL) << "the run was over before kill " << kill;
  }
  ASSERT_EQ(run("killed", often), 0);
  expect_same_weights(policy("whole"), policy("killed"));
  expect_same_weights(best("whole"), best("killed"));
}

TEST_F(TrainCommandTest, TheBatteryHasNoPartInTheWeights) {
  const std::vector<std::string> off = {"--set", "gate.enabled=false"};
  std::vector<std::string> none = off;
  none.insert(none.end(), {"--set", "battery.every_updates=0"});
  ASSERT_EQ(run("with", off), 0);
  ASSERT_EQ(run("without", none), 0);
  expect_same_weights(policy("with"), policy("without"));
  EXPECT_TRUE(std::filesystem::exists(folder_.path("with/best.safetensors")));
  EXPECT_FALSE(std::filesystem::exists(folder_.path("without/best.safetensors")));
  expect_refused("refused", {"--set", "battery.every_updates=0"}, "gate.enabled");
}

TEST_F(TrainCommandTest, TheBestPolicySaysWhenItWasTakenAndWhatTheBatteryMeasured) {
  ASSERT_EQ(run("a", {}), 0);
  const auto provenance = best("a").spec.provenance;
  EXPECT_LE(std::stoi(provenance.at("transitions")),
            std::stoi(policy("a").spec.provenance.at("transitions")));
  EXPECT_NE(provenance.at("battery").find("alive"), std::string::npos);
}

TEST_F(TrainCommandTest, HardGroundAloneCanBeTrainedOn) {
  EXPECT_EQ(run("a", {"--set", "ground.rigid_envs=64", "--set", "ground.patchy_envs=0", "--set",
                      "run.transitions=600"}),
            0);
}

TEST_F(TrainCommandTest, UnknownWiringIsRefused) {
  expect_refused("a", {"--set", "network.encoder=gru"}, "network.encoder: found 'gru', expected");
  expect_refused("a", {"--set", "network.actor=\"estimate, sight\""},
                 "network.actor: found 'sight', expected some of encoding, estimate");
  expect_refused("a", {"--set", "imitation.teacher=teacher.safetensors"}, "teacher.safetensors");
}

TEST_F(TrainCommandTest, AStudentThatIsKilledResumesToTheWeightsOfAnUninterruptedRun) {
  const std::string actor = "network.actor=\"encoding, proprioception\"";
  ASSERT_EQ(run("teacher", {"--set", actor, "--set", "network.encoder=insight"}), 0);
  std::vector<std::string> words = {
      "--set", actor, "--set",
      "imitation.teacher=" + folder_.path("teacher") + "/best.safetensors"};
  ASSERT_EQ(run("whole", words), 0);
  words.insert(words.end(), kOften.begin(), kOften.end());
  CheckpointWatch watch(folder_.path("killed"));
  ChildProcess child(training("killed", words));
  EXPECT_TRUE(watch.wait_for(2));
  child.signal(SIGKILL);
  EXPECT_EQ(child.wait().code, 128 + SIGKILL) << "the run was over before the kill";
  words.emplace_back("--resume");
  ASSERT_EQ(run("killed", words), 0);
  expect_same_weights(policy("killed"), policy("whole"));
  EXPECT_NE(policy("whole").spec.provenance.at("origin").find("imitating 'raibo'"),
            std::string::npos);
}

TEST_F(TrainCommandTest, JudgeRunsTheBatteryWithAPolicyThatStandsOnHardGround) {
  const std::string path = folder_.path("standing.safetensors");
  ASSERT_EQ(run("a", {}), 0);
  PolicyFile standing = policy("a");
  for (float& weight : standing.parameters.actor.back().weight) weight = 0.0f;
  for (float& bias : standing.parameters.actor.back().bias) bias = 0.0f;
  standing.golden = make_golden_example(standing.parameters);
  write_policy_file(path, standing);
  const Ended ended = run_process({SANDRUNNER_TRAIN_PROGRAM, "--judge", path, "--set",
                                   "battery.runs=2", "--set", "battery.duration_s=1", "--set",
                                   "ground.rigid_envs=64", "--set", "ground.patchy_envs=0", "--set",
                                   "policy.kp_nmprad=150", "--set", "policy.kd_nmsprad=3"});
  EXPECT_EQ(ended.code, 0) << ended;
  EXPECT_NE(ended.out.find("alive 1.000, error"), std::string::npos) << ended;
  EXPECT_NE(ended.out.find("\nrigid              2/2     2/2     2/2     2/2     2/2\n"),
            std::string::npos)
      << ended;
}

TEST_F(TrainCommandTest, AnotherWiringEndsInAFileThatNoRobotRuns) {
  ASSERT_EQ(run("a", {"--set", "network.actor=\"encoding, estimate, terrain\""}), 0);
  const std::string path = folder_.path("a") + "/best.safetensors";
  const PolicyFile file = read_policy_file(path);
  EXPECT_TRUE(file.parameters.wiring.actor_sees.terrain);
  EXPECT_NE(file.spec.provenance.at("battery").find("alive"), std::string::npos);
  EXPECT_THROW(load_policy(path), InputError);
}

TEST_F(TrainCommandTest, GoesOnFromThePolicyOfAFileAndSaysSo) {
  ASSERT_EQ(run("first", {"--seed", "3"}), 0);
  const std::string first = folder_.path("first/policy.safetensors");
  ASSERT_EQ(
      run("second", {"--from", first, "--set", "learner.learning_rate_start=1e-9", "--set",
                     "learner.learning_rate_min=1e-9", "--set", "learner.learning_rate_max=1e-9"}),
      0);
  const PolicyFile a = policy("first"), b = policy("second");
  for (std::size_t i = 0; i < a.parameters.encoder_weight_hh.size(); ++i) {
    ASSERT_NEAR(a.parameters.encoder_weight_hh[i], b.parameters.encoder_weight_hh[i], 1e-6);
  }
  for (std::size_t i = 0; i < a.parameters.actor[2].weight.size(); ++i) {
    ASSERT_NEAR(a.parameters.actor[2].weight[i], b.parameters.actor[2].weight[i], 1e-6);
  }
  EXPECT_NE(b.spec.provenance.at("origin").find("from the weights of policy 'raibo'"),
            std::string::npos);
  EXPECT_NE(a.spec.provenance.at("origin").find("from random weights"), std::string::npos);
  expect_refused("third", {"--from", first, "--resume"}, "--from");
}

TEST_F(TrainCommandTest, APolicyWhoseInputsAreScaledOtherwiseIsNotGoneOnFrom) {
  ASSERT_EQ(run("first", {}), 0);
  PolicyFile other = policy("first");
  other.parameters.observation_variance[9] *= 25.0f;
  other.golden = make_golden_example(other.parameters);
  const std::string path = folder_.path("other.safetensors");
  write_policy_file(path, other);
  expect_refused("second", {"--from", path}, "variance of observation 9");
  EXPECT_FALSE(std::filesystem::exists(folder_.path("second")));
}

TEST_F(TrainCommandTest, ASeedBelowZeroIsRefused) {
  expect_refused("first", {"--seed", "-1"}, "--seed");
}

TEST_F(TrainCommandTest, LinesOfProgressAreShortAndExplained) {
  const Ended ended = run_process(training("a", {}));
  EXPECT_EQ(ended.code, 0);
  std::istringstream lines(ended.out);
  std::string hint, progress;
  std::getline(lines, hint);
  std::getline(lines, progress);
  EXPECT_NE(hint.find("--explain"), std::string::npos) << ended.out;
  EXPECT_LE(progress.size(), 100u) << ended.out;
  EXPECT_TRUE(progress.ends_with(" min left")) << progress;
  const Ended explained = run_process({SANDRUNNER_TRAIN_PROGRAM, "--explain"});
  EXPECT_EQ(explained.code, 0);
  for (const char* word : {"k/s", "Hz", "trot", "alive", "error", "cost", "fast", "late", "min"}) {
    EXPECT_NE(explained.out.find(word), std::string::npos) << word;
  }
}

TEST_F(TrainCommandTest, TheLastLinesSayWhatCameOfItAndHowToRunThePolicy) {
  const Ended ended = run_process(training("a", {}));
  EXPECT_NE(ended.out.find(" % of the battery's runs ended without a fall, velocity error "),
            std::string::npos)
      << ended.out;
  EXPECT_NE(ended.out.find(": not a gait yet (a gait has 80 % and at most 0.20)\nwrote "),
            std::string::npos)
      << ended.out;
  const auto found = ended.out.find("run it with sandrunner --policy ");
  ASSERT_NE(found, std::string::npos) << ended.out;
  const auto path = ended.out.rfind(' ') + 1;
  EXPECT_TRUE(std::filesystem::exists(ended.out.substr(path, ended.out.size() - path - 1)));
}

TEST_F(TrainCommandTest, BadInputIsRefusedInOneLine) {
  expect_refused("a", {"--set", "reward.velocity.wieght=1"}, "'reward.velocity.weight'?");
  expect_refused("a", {"--set", "reward.debt=0.6"}, "unknown key 'reward.debt'");
  expect_refused("a", {"--set", "learner.gamma=1.5"}, "learner.gamma");
  expect_refused("a", {"--set", "ground.friction_low=2", "--set", "ground.friction_high=1"},
                 "ground.friction_low");
  expect_refused("a", {"--set", "run.envs=100"}, "run.envs");
  // What no policy file may hold, no robot may be given, or nothing can be learnt with.
  expect_refused("a", {"--set", "command.centripetal_mps2=0"}, "command.centripetal_mps2");
  expect_refused("a", {"--set", "command.backward_mps=200"}, "command.backward_mps");
  expect_refused("a", {"--set", "policy.kp_nmprad=201"}, "the robot 'raibo' takes at most 200");
  expect_refused("a", {"--set", "command.zero_share=0.8"}, "command.in_place_share = 1.05");
  expect_refused("a", {"--set", "learner.block_envs=40", "--set", "run.envs=80"},
                 "learner.block_envs = 40");
  expect_refused("a", {"--set", "learner.critic=[128.7]"}, "learner.critic: 128.7");
  expect_refused("a", {"--set", "learner.gamma=1"}, "gamma");
  expect_refused("a", {"--set", "ground.sigma_flat_low_start=1e8"}, "sigma_flat_low_start");
  expect_refused("a", {"--robot", folder_.path("absent.toml")}, "absent.toml");
  expect_refused("a", {"--config", folder_.path("absent.toml")}, "absent.toml");
  expect_refused("a", {"--resume"}, "checkpoint.bin");
  EXPECT_FALSE(std::filesystem::exists(folder_.path("a")));
}

TEST_F(TrainCommandTest, PolicyFileNamesTheRobotOfTheMapAndItsTorqueLimit) {
  const std::vector<std::string> brief = {"--set", "run.transitions=600"};
  std::vector<std::string> with_mule = brief;
  with_mule.insert(with_mule.end(), {"--robot", mule()});
  ASSERT_EQ(run("mule", with_mule), 0);
  const PolicySpec spec = policy("mule").spec;
  EXPECT_EQ(spec.name, "mule");
  EXPECT_EQ(spec.provenance.at("robot"), "mule");
  EXPECT_EQ(spec.torque_limit_nm, 41.5);

  ASSERT_EQ(run("raibo", brief), 0);
  EXPECT_EQ(policy("raibo").spec.name, "raibo");
  EXPECT_EQ(policy("raibo").spec.torque_limit_nm, 63.45);
}

TEST_F(TrainCommandTest, ARobotThatShipsIsTrainedByItsName) {
  const Ended ended =
      run_process(training("go2", {"--set", "run.transitions=600", "--robot", "go2"}));
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_NE(ended.out.find("run it with sandrunner --robot go2 --policy "), std::string::npos)
      << ended.out;
  const PolicySpec spec = policy("go2").spec;
  EXPECT_EQ(spec.provenance.at("robot"), "go2");
  EXPECT_EQ(spec.joint_names[0], "FL_hip_joint");
  EXPECT_EQ(spec.torque_limit_nm, 45.43);
  EXPECT_EQ(spec.kp_nmprad, 30.0);
}

TEST_F(TrainCommandTest, CheckpointOfAnotherRobotIsRefused) {
  const std::vector<std::string> brief = {"--set", "run.transitions=600"};
  ASSERT_EQ(run("r", brief), 0);
  expect_refused("r", {"--resume", "--set", "run.transitions=600", "--robot", mule()},
                 "another robot than this 'mule'");
}

TEST_F(TrainCommandTest, FolderThatCannotBeWrittenIsRefusedBeforeTheTraining) {
  write_file(folder_.path("file"), "");
  expect_refused("file", {}, "--out");
}

TEST_F(TrainCommandTest, TheCurveIsAPageThatAsksForNothingToo) {
  ASSERT_EQ(run("a", {}), 0);
  const std::string page = read_file(folder_.path("a") + "/curve.html");
  EXPECT_TRUE(page.starts_with("<!doctype html>"));
  EXPECT_LT(page.size(), 2'000'000u);
  for (const char* part : {"id=\"curve-data\"", "id=\"frames\"", "id=\"program\""}) {
    EXPECT_NE(page.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(page.find("src=\""), std::string::npos);
}

// The page's run of the policy, after each window or only at the end, has no part in the weights.
TEST_F(TrainCommandTest, InterruptKeepsEverythingAndResumeEndsInTheSameWeights) {
  ASSERT_EQ(run("whole", {"--threads", "1"}), 0);
  CheckpointWatch watch(folder_.path("stopped"));
  ChildProcess child(training("stopped", kOften));
  EXPECT_TRUE(watch.wait_for(2));
  child.signal(SIGINT);
  ASSERT_EQ(child.wait().code, 0);
  EXPECT_LT(std::stoi(policy("stopped").spec.provenance.at("transitions")), 12800);
  EXPECT_TRUE(std::filesystem::exists(folder_.path("stopped") + "/curve.csv"));
  std::vector<std::string> again = kOften;
  again.push_back("--resume");
  ASSERT_EQ(run("stopped", again), 0);
  expect_same_weights(policy("whole"), policy("stopped"));
}

TEST_F(TrainCommandTest, ResumeOfACompleteTrainingChangesNothing) {
  ASSERT_EQ(run("c", {}), 0);
  const std::string before = read_file(folder_.path("c") + "/policy.safetensors");
  ASSERT_EQ(run("c", {"--resume"}), 0);
  EXPECT_EQ(read_file(folder_.path("c") + "/policy.safetensors"), before);
}

TEST_F(TrainCommandTest, ATrainingCanBeMadeLongerAndSaysWhatThatMeans) {
  ASSERT_EQ(run("l", {"--set", "run.transitions=1024"}), 0);
  const Ended longer = run_process(training("l", {"--resume", "--set", "run.transitions=2048"}));
  ASSERT_EQ(longer.code, 0) << longer;
  EXPECT_NE(longer.err.find("run.transitions is larger than before"), std::string::npos) << longer;
  const auto provenance = policy("l").spec.provenance;
  EXPECT_EQ(provenance.at("transitions"), "2048");
  EXPECT_NE(provenance.at("origin").find("made longer at 1024 transitions"), std::string::npos);
  // It settles at the new end.
  const std::string curve = read_file(folder_.path("l") + "/curve.csv");
  EXPECT_EQ(std::count(curve.begin(), curve.end(), '\n'), 5) << curve;
  EXPECT_EQ(run("l", {"--resume", "--set", "run.transitions=2048"}), 0);
  expect_refused("l", {"--resume", "--set", "run.transitions=1024"}, "can only be made longer");
}

TEST_F(TrainCommandTest, ForeignAndTruncatedCheckpointsAreRefusedAndLeftAlone) {
  ASSERT_EQ(run("b", {"--set", "run.transitions=600"}), 0);
  const std::string path = folder_.path("b") + "/checkpoint.bin";
  const std::string good = read_file(path);
  expect_refused("b", {}, "holds a training");
  expect_refused("b", {"--resume", "--set", "run.transitions=600", "--set", "learner.window=16"},
                 "checkpoint.bin: found learner.window = 16, expected 8");
  expect_refused("b", {"--resume", "--set", "run.transitions=600", "--seed", "3"},
                 "found --seed 3, expected 1");
  expect_refused("b", {"--resume", "--set", "run.transitions=512"},
                 "found run.transitions = 512, expected at least the 600 of the checkpoint");
  write_file(path, good.substr(0, good.size() / 2));
  expect_refused("b", {"--resume", "--set", "run.transitions=600"}, "checkpoint.bin");
  EXPECT_EQ(read_file(path).size(), good.size() / 2);
}

}  // namespace
}  // namespace sandrunner
