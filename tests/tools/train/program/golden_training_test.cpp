// SPDX-License-Identifier: BSD-3-Clause
// The weights in which a short training ends: the built-in settings, but for those below.
#include <gtest/gtest.h>

#include "policy/policy_file.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"
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

std::uint64_t weights_after_training(const std::string& threads) {
  const TemporaryFolder work;
  const std::string folder = work.path("run");
  std::vector<std::string> words = {SANDRUNNER_TRAIN_PROGRAM, "--out", folder, "--threads",
                                    threads};
  for (const std::string& setting : kSettings) words.insert(words.end(), {"--set", setting});
  EXPECT_EQ(run_process(words).code, 0);
  PolicyFile policy = read_policy_file(folder + "/policy.safetensors");
  std::uint64_t hash = learner::kHashStart;
  for (const NamedTensor& tensor : tensors_of(policy.parameters)) {
    const std::vector<float>& values = *tensor.values;
    hash = learner::fnv1a({reinterpret_cast<const char*>(values.data()), 4 * values.size()}, hash);
  }
  return hash;
}

TEST(GoldenTrainingTest, EndsInTheRecordedWeights) {
  EXPECT_EQ(weights_after_training("2"), kWeights);
}

TEST(GoldenTrainingTest, DoesWithAnotherNumberOfThreadsToo) {
  EXPECT_EQ(weights_after_training("1"), kWeights);
}

}  // namespace
}  // namespace sandrunner
