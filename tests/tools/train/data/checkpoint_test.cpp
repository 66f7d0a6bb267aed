// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/data/checkpoint.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner::learner {
namespace {

/// A checkpoint in a file.
class CheckpointTest : public testing::Test {
 protected:
  CheckpointTest() {
    saved_.architecture = "hidden 64";
    saved_.config_hash = 0x0123456789abcdefULL;
    const std::vector<float> weights(5000, 0.25f);
    const std::uint64_t count = 42;
    saved_.put("weights", weights.data(), weights.size());
    saved_.put("count", &count, 1);
    saved_.put<char>("empty", nullptr, 0);
    save_checkpoint(saved_, path_);
  }
  /// The message with which loading these bytes is refused; "" if it is not.
  std::string refusal(const std::string& bytes) const {
    write_file(path_, bytes);
    std::string message = error_of([&] { load_checkpoint(path_); });
    EXPECT_TRUE(message.empty() || message.starts_with(path_)) << message;
    return message;
  }

  const TemporaryFolder folder_;
  const std::string path_ = folder_.path("checkpoint.bin");
  Checkpoint saved_;
};

TEST_F(CheckpointTest, ReturnsWhatWasSaved) {
  const Checkpoint loaded = load_checkpoint(path_);
  EXPECT_EQ(loaded.architecture, saved_.architecture);
  EXPECT_EQ(loaded.config_hash, saved_.config_hash);
  EXPECT_EQ(loaded.sections, saved_.sections);
  std::uint64_t count = 0;
  loaded.get("count", &count, 1);
  EXPECT_EQ(count, 42u);
}

TEST_F(CheckpointTest, NamesTheSectionThatIsMissingOrOfAnotherSize) {
  const Checkpoint loaded = load_checkpoint(path_);
  float values[2];
  EXPECT_EQ(error_of([&] { loaded.get("bias", values, 2); }),
            path_ + ": checkpoint has no section 'bias'");
  EXPECT_EQ(error_of([&] { loaded.get("weights", values, 2); }),
            path_ + ": section 'weights' has 20000 bytes, expected 8");
}

TEST_F(CheckpointTest, RefusesEveryTruncation) {
  const std::string whole = read_file(path_);
  for (const std::size_t size : {std::size_t{0}, std::size_t{7}, std::size_t{39}, std::size_t{40},
                                 whole.size() / 2, whole.size() - 1}) {
    EXPECT_NE(refusal(whole.substr(0, size)), "") << size << " bytes";
  }
  EXPECT_NE(refusal(whole.substr(0, whole.size() / 2)).find("truncated"), std::string::npos);
}

TEST_F(CheckpointTest, RefusesEveryChangedByte) {
  const std::string whole = read_file(path_);
  for (std::size_t i = 0; i < whole.size(); i += i < 100 ? 1 : 997) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    EXPECT_NE(refusal(damaged), "") << "byte " << i;
  }
}

TEST_F(CheckpointTest, RefusesWhatIsNotThereOrIsSomethingElse) {
  const std::string none = folder_.path("none");
  EXPECT_TRUE(
      error_of([&] { load_checkpoint(none); }).starts_with(none + ": cannot be read (No such"));
  EXPECT_NE(refusal(std::string(1000, 'x')).find("no training checkpoint"), std::string::npos);
}

}  // namespace
}  // namespace sandrunner::learner
