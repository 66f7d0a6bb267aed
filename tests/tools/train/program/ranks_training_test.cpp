// SPDX-License-Identifier: BSD-3-Clause
// Several processes that make one training.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <iterator>
#include <sstream>

#include "tests/support/wait_until.h"
#include "tests/tools/train/program/train_command.h"

namespace sandrunner {
namespace {

std::vector<pid_t> children_of(pid_t parent) {
  std::istringstream list(read_file("/proc/" + std::to_string(parent) + "/task/" +
                                    std::to_string(parent) + "/children"));
  return {std::istream_iterator<pid_t>(list), {}};
}

struct RanksTrainingTest : TrainCommandTest {
  void SetUp() override {
    if (!has_mpi()) GTEST_SKIP() << kNoMpi;
  }
  std::vector<std::string> by_ranks(int ranks, const std::string& out,
                                    const std::vector<std::string>& more) const {
    std::vector<std::string> words = with_ranks(ranks), rest = training(out, more);
    words.insert(words.end(), rest.begin() + 1, rest.end());
    return words;
  }
};

TEST_F(RanksTrainingTest, AKilledRankEndsAllAndTheRestIsDoneByAnotherNumber) {
  const std::vector<std::string> blocks = {"--set", "run.envs=256", "--set",
                                           "learner.symmetry_weight=0.015"};
  std::vector<std::string> often = kOften;
  often.insert(often.end(), blocks.begin(), blocks.end());
  ASSERT_EQ(run("whole", blocks), 0);
  {
    CheckpointWatch watch(folder_.path("killed"));
    ChildProcess mpirun(by_ranks(3, "killed", often));
    ASSERT_TRUE(watch.wait_for(2));
    const std::vector<pid_t> ranks = children_of(mpirun.pid());
    ASSERT_EQ(ranks.size(), 3u);
    const auto begin = std::chrono::steady_clock::now();
    kill(ranks[1], SIGKILL);
    EXPECT_NE(mpirun.wait().code, 0);
    const auto ended = [&] {
      return std::ranges::none_of(ranks, [](pid_t rank) { return kill(rank, 0) == 0; });
    };
    EXPECT_TRUE(wait_until(ended, 10));
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
  }
  often.push_back("--resume");
  const Ended ended = run_process(by_ranks(2, "killed", often));
  ASSERT_EQ(ended.code, 0) << ended;
  expect_same_weights(policy("whole"), policy("killed"));
  expect_same_weights(best("whole"), best("killed"));
}

TEST_F(RanksTrainingTest, OnlyTheFirstRankSpeaks) {
  const Ended ended = run_process(by_ranks(2, "run", {}));
  ASSERT_EQ(ended.code, 0) << ended;
  const std::string last = "wrote " + folder_.path("run");
  const std::size_t at = ended.out.find(last);
  ASSERT_NE(at, std::string::npos) << ended;
  EXPECT_EQ(ended.out.find(last, at + 1), std::string::npos) << ended;
  EXPECT_EQ(ended.err.find("sandrunner"), std::string::npos) << ended;
}

TEST_F(RanksTrainingTest, WhatIsRefusedEndsAllWithItsExitCode) {
  const Ended ended = run_process(by_ranks(2, "run", {"--set", "run.envs=65"}));
  EXPECT_EQ(ended.code, 2);
  EXPECT_NE(ended.err.find("run.envs"), std::string::npos) << ended;
}

}  // namespace
}  // namespace sandrunner
