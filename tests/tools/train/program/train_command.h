// SPDX-License-Identifier: BSD-3-Clause
// A short training by the program, for the tests of what it does.
#pragma once

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "policy/policy_file.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {

// 64 robots, 25 windows of 8 steps; what comes late in a training comes soon, the settling too,
// every window has episodes that end in time, and every tenth a short battery that any policy
// passes that stands.
inline const std::vector<std::string> kShort = {"--set", "run.envs=64",
                                                "--set", "run.transitions=12800",
                                                "--set", "learner.window=8",
                                                "--set", "learner.minibatches=1",
                                                "--set", "run.settle_share=0.5",
                                                "--set", "episode.length_s=0.2",
                                                "--set", "battery.every_updates=10",
                                                "--set", "battery.runs=1",
                                                "--set", "battery.duration_s=1",
                                                "--set", "battery.tracked_error=100",
                                                "--set", "gate.least_alive=0",
                                                "--set", "gate.rise_transitions=5120",
                                                "--set", "reward.prior_start_transitions=0",
                                                "--set", "reward.prior_end_transitions=6400"};
// With a checkpoint after every window.
inline const std::vector<std::string> kOften = {"--threads", "1", "--set",
                                                "run.checkpoint_interval_s=0"};

// Waits for checkpoints to be written into a folder.
class CheckpointWatch {
 public:
  explicit CheckpointWatch(const std::string& folder) : notify_(::inotify_init1(IN_CLOEXEC)) {
    std::filesystem::create_directories(folder);
    EXPECT_GE(::inotify_add_watch(notify_, folder.c_str(), IN_MOVED_TO), 0) << folder;
  }
  ~CheckpointWatch() { ::close(notify_); }
  CheckpointWatch(const CheckpointWatch&) = delete;
  CheckpointWatch& operator=(const CheckpointWatch&) = delete;

  /// False if there have not been this many more after a minute.
  bool wait_for(int checkpoints) {
    pollfd ready{notify_, POLLIN, 0};
    while (checkpoints > 0 && ::poll(&ready, 1, 60'000) == 1) {
      alignas(inotify_event) char events[4096];
      const ssize_t bytes = ::read(notify_, events, sizeof(events));
      for (ssize_t at = 0; at < bytes;) {
        const auto& event = *reinterpret_cast<const inotify_event*>(events + at);
        checkpoints -= std::string_view(event.name) == "checkpoint.bin";
        at += static_cast<ssize_t>(sizeof(event) + event.len);
      }
    }
    return checkpoints <= 0;
  }

 private:
  int notify_;
};

inline constexpr const char* kNoMpi =
    "needs mpirun and mpi.h: Debian's openmpi-bin and libopenmpi-dev";
inline bool has_mpi() { return *SANDRUNNER_TRAIN_MPI_PROGRAM != '\0'; }
/// The words that start this number of ranks of the program.
inline std::vector<std::string> with_ranks(int ranks) {
  return {"mpirun", "--allow-run-as-root", "--oversubscribe",           "--bind-to", "none",
          "-n",     std::to_string(ranks), SANDRUNNER_TRAIN_MPI_PROGRAM};
}

class TrainCommandTest : public testing::Test {
 protected:
  /// The program on the short training.
  std::vector<std::string> training(const std::string& out,
                                    const std::vector<std::string>& more) const {
    std::vector<std::string> words = {SANDRUNNER_TRAIN_PROGRAM, "--out", folder_.path(out)};
    words.insert(words.end(), kShort.begin(), kShort.end());
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  int run(const std::string& out, const std::vector<std::string>& more) const {
    return run_process(training(out, more)).code;
  }
  PolicyFile policy(const std::string& out, const char* file = "policy.safetensors") const {
    return read_policy_file(folder_.path(out) + "/" + file);
  }
  PolicyFile best(const std::string& out) const { return policy(out, "best.safetensors"); }
  void expect_same_weights(PolicyFile a, PolicyFile b) const {
    const auto expected = tensors_of(a.parameters), found = tensors_of(b.parameters);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_EQ(*found.at(i).values, *expected[i].values) << expected[i].name;
    }
  }
  void expect_refused(const std::string& out, const std::vector<std::string>& more,
                      const std::string& named) {
    const Ended ended = run_process(training(out, more));
    EXPECT_EQ(ended.code, 2) << named;
    const std::string& error = ended.err;
    EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 1) << error;
    EXPECT_NE(error.find(named), std::string::npos) << error;
  }
  /// A robot map of the test's own: Raibo under another name, with weaker drives.
  std::string mule() const {
    const auto changed = [](std::string text, const std::string& from, const std::string& to) {
      EXPECT_NE(text.find(from), std::string::npos) << from;
      for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
        text.replace(at, from.size(), to);
      }
      return text;
    };
    const std::string raibo = SANDRUNNER_ROBOT_FOLDER "/raibo";
    write_file(folder_.path("mule.urdf"),
               changed(read_file(raibo + ".urdf"), "effort=\"63.45\"", "effort=\"41.5\""));
    write_file(folder_.path("mule.toml"), changed(read_file(raibo + ".toml"), "raibo", "mule"));
    return folder_.path("mule.toml");
  }
  const TemporaryFolder folder_;
};

}  // namespace sandrunner
