// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/data/checkpoint.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "rt/base/errors.h"

namespace sandrunner::learner {
namespace {

namespace fs = std::filesystem;

class CheckpointTest : public testing::Test {
 protected:
  CheckpointTest()
      : folder_(fs::path(testing::TempDir()) /
                (std::string("checkpoint_") +
                 testing::UnitTest::GetInstance()->current_test_info()->name())),
        path_((folder_ / "checkpoint.bin").string()) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~CheckpointTest() override { fs::remove_all(folder_); }

  static Checkpoint example() {
    Checkpoint checkpoint;
    checkpoint.architecture = "hidden 64";
    checkpoint.config_hash = 0x0123456789abcdefULL;
    const std::vector<float> weights(5000, 0.25f);
    const std::uint64_t count = 42;
    checkpoint.put("weights", weights.data(), weights.size());
    checkpoint.put("count", &count, 1);
    checkpoint.put<char>("empty", nullptr, 0);
    return checkpoint;
  }
  std::string read() const {
    std::ifstream file(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  void write(const std::string& bytes) const {
    std::ofstream(path_, std::ios::binary | std::ios::trunc) << bytes;
  }
  /// The one-line message with which loading is refused; "" if it is not.
  std::string refusal() const {
    try {
      load_checkpoint(path_);
    } catch (const InputError& error) {
      std::string message = error.what();
      EXPECT_EQ(message.find('\n'), std::string::npos);
      EXPECT_NE(message.find(path_), std::string::npos);
      return message;
    }
    return "";
  }

  fs::path folder_;
  std::string path_;
};

TEST_F(CheckpointTest, ReturnsWhatWasSaved) {
  const Checkpoint saved = example();
  save_checkpoint(saved, path_);
  const Checkpoint loaded = load_checkpoint(path_);
  EXPECT_EQ(loaded.architecture, saved.architecture);
  EXPECT_EQ(loaded.config_hash, saved.config_hash);
  EXPECT_EQ(loaded.sections, saved.sections);
  std::uint64_t count = 0;
  loaded.get("count", &count, 1);
  EXPECT_EQ(count, 42u);
  EXPECT_FALSE(fs::exists(path_ + ".part"));
}

TEST_F(CheckpointTest, NamesTheSectionThatIsMissingOrOfAnotherSize) {
  save_checkpoint(example(), path_);
  const Checkpoint loaded = load_checkpoint(path_);
  float values[2];
  EXPECT_THROW(loaded.get("bias", values, 2), InputError);
  try {
    loaded.get("weights", values, 2);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()), path_ + ": section 'weights' has 20000 bytes, expected 8");
  }
}

TEST_F(CheckpointTest, RefusesEveryTruncation) {
  save_checkpoint(example(), path_);
  const std::string whole = read();
  for (const std::size_t size : {std::size_t{0}, std::size_t{7}, std::size_t{39}, std::size_t{40},
                                 whole.size() / 2, whole.size() - 1}) {
    write(whole.substr(0, size));
    EXPECT_NE(refusal(), "") << size << " bytes";
  }
  write(whole.substr(0, whole.size() / 2));
  EXPECT_NE(refusal().find("truncated"), std::string::npos);
}

TEST_F(CheckpointTest, RefusesEveryChangedByte) {
  save_checkpoint(example(), path_);
  const std::string whole = read();
  for (std::size_t i = 0; i < whole.size(); i += i < 100 ? 1 : 997) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    write(damaged);
    EXPECT_NE(refusal(), "") << "byte " << i;
  }
}

TEST_F(CheckpointTest, RefusesWhatIsNotThereOrIsSomethingElse) {
  EXPECT_NE(refusal().find("cannot be read"), std::string::npos);
  write(std::string(1000, 'x'));
  EXPECT_NE(refusal().find("no training checkpoint"), std::string::npos);
}

TEST_F(CheckpointTest, FullDiskLeavesTheLastGoodFile) {
  save_checkpoint(example(), path_);
  const std::string before = read();
  Checkpoint larger = example();
  const std::vector<char> state(200000, 'a');
  larger.put("state", state.data(), state.size());
  // A limit on the size of files stops the write halfway, as a full disk does.
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
  const rlimit old_limit = limit;
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  limit.rlim_cur = 100000;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  std::string message;
  try {
    save_checkpoint(larger, path_);
  } catch (const InputError& error) {
    message = error.what();
  }
  setrlimit(RLIMIT_FSIZE, &old_limit);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_EQ(message, path_ + ": cannot be written (File too large)");
  EXPECT_EQ(read(), before);
  EXPECT_FALSE(fs::exists(path_ + ".part"));
}

TEST_F(CheckpointTest, MissingFolderIsAnError) {
  EXPECT_THROW(save_checkpoint(example(), (folder_ / "no" / "such.bin").string()), InputError);
}

}  // namespace
}  // namespace sandrunner::learner
