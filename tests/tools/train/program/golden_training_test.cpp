// SPDX-License-Identifier: BSD-3-Clause
// The weights in which a short training ends: the built-in settings, but for those below.
#include <gtest/gtest.h>

#include "tests/tools/train/program/train_command.h"
#include "tools/train/data/checkpoint.h"

namespace sandrunner {
namespace {

// 128 robots in two blocks, 13 windows of 8 steps, on every kind of ground. Episodes end and the
// late penalties rise within them.
const std::vector<std::string> kSettings = {
    "run.envs=128",
    "run.transitions=12800",
    "run.settle_share=0.5",
    "learner.window=8",
    "learner.minibatches=1",
    "learner.symmetry_weight=0.015",
    "episode.length_s=0.2",
    "battery.every_updates=0",
    "gate.enabled=false",
    "gate.rise_transitions=5120",
    "reward.prior_start_transitions=0",
    "reward.prior_end_transitions=6400",
};

// Of a change that is meant to leave trainings as they are, this value is the proof. A change of
// the training itself records another.
constexpr std::uint64_t kWeights = 0x1f90ea82e84bef4d;

// `program`: its words before the settings.
std::uint64_t weights_after_training(std::vector<std::string> program, const std::string& threads) {
  const TemporaryFolder work;
  const std::string folder = work.path("run");
  program.insert(program.end(), {"--out", folder, "--threads", threads});
  for (const std::string& setting : kSettings) program.insert(program.end(), {"--set", setting});
  const Ended ended = run_process(program);
  EXPECT_EQ(ended.code, 0) << ended;
  PolicyFile policy = read_policy_file(folder + "/policy.safetensors");
  std::uint64_t hash = learner::kHashStart;
  for (const NamedTensor& tensor : tensors_of(policy.parameters)) {
    const std::vector<float>& values = *tensor.values;
    hash = learner::fnv1a({reinterpret_cast<const char*>(values.data()), 4 * values.size()}, hash);
  }
  return hash;
}

TEST(GoldenTrainingTest, EndsInTheRecordedWeights) {
  EXPECT_EQ(weights_after_training({SANDRUNNER_TRAIN_PROGRAM}, "2"), kWeights);
}

TEST(GoldenTrainingTest, DoesWithAnotherNumberOfThreadsToo) {
  EXPECT_EQ(weights_after_training({SANDRUNNER_TRAIN_PROGRAM}, "1"), kWeights);
}

TEST(GoldenTrainingTest, DoesWithAnyNumberOfRanksToo) {
  if (!has_mpi()) GTEST_SKIP() << kNoMpi;
  for (const int ranks : {1, 2, 4}) {
    for (const char* threads : {"1", "2"}) {
      EXPECT_EQ(weights_after_training(with_ranks(ranks), threads), kWeights)
          << ranks << " ranks, " << threads << " threads";
    }
  }
}

}  // namespace
}  // namespace sandrunner
