// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/output_files.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <filesystem>
#include <string>

#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

TEST(WriteFileTest, BytesComeBackAsTheyAre) {
  const TemporaryFolder folder;
  const std::string bytes("text\r\n\0\xff", 8);
  write_file(folder.path("file"), "something longer than that");
  write_file(folder.path("file"), bytes);
  EXPECT_EQ(read_file(folder.path("file")), bytes);
  EXPECT_EQ(folder.number_of_files(), 1u);
}

TEST(WriteFileTest, PathAndReasonAreNamedAndNothingIsLeft) {
  const TemporaryFolder folder;
  const std::string absent = folder.path("absent/file");
  EXPECT_EQ(error_of([&] { write_file(absent, "new"); }),
            absent + ": cannot be written (No such file or directory)");
  EXPECT_EQ(error_of([] { write_file("/dev/full", "new"); }),
            "/dev/full: cannot be written (not a regular file)");
  EXPECT_EQ(error_of([&] { write_file(folder.path(""), "new"); }),
            folder.path("") + ": cannot be written (not a regular file)");
  EXPECT_EQ(folder.number_of_files(), 0u);
}

TEST(WriteFileTest, PartThatAKilledProgramLeftIsReplaced) {
  const TemporaryFolder folder;
  write_file(folder.path("file.part"), "left over, and longer");
  write_file(folder.path("file"), "new");
  EXPECT_EQ(read_file(folder.path("file")), "new");
  EXPECT_EQ(folder.number_of_files(), 1u);
}

TEST(WriteFileTest, OldContentSurvivesADiskThatIsFull) {
  const TemporaryFolder folder;
  const std::string path = folder.path("file");
  write_file(path, "old");
  const auto old_handler = signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  getrlimit(RLIMIT_FSIZE, &limit);
  const rlimit small{4096, limit.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  const std::string error = error_of([&] { write_file(path, std::string(8192, 'x')); });
  setrlimit(RLIMIT_FSIZE, &limit);
  signal(SIGXFSZ, old_handler);
  EXPECT_EQ(error, path + ": cannot be written (File too large)");
  EXPECT_EQ(read_file(path), "old");
  EXPECT_EQ(folder.number_of_files(), 1u);
}

TEST(WholeFileTest, LinksAreReplacedAndNotFollowed) {
  const TemporaryFolder folder;
  const std::string victim = folder.path("victim"), path = folder.path("file");
  write_file(victim, "precious");
  std::filesystem::create_symlink(victim, path + ".part");
  std::filesystem::create_symlink(victim, path);
  write_file(path, "new");
  EXPECT_EQ(read_file(victim), "precious");
  EXPECT_EQ(read_file(path), "new");
  EXPECT_EQ(folder.number_of_files(), 2u);
}

TEST(WholeFileTest, WhatIsNotKeptIsGone) {
  const TemporaryFolder folder;
  const std::string path = folder.path("file");
  {
    WholeFile file(path);
    file.write("half");
    EXPECT_EQ(read_file(file.part_path()), "half");
  }
  EXPECT_EQ(folder.number_of_files(), 0u);
}

}  // namespace
}  // namespace sandrunner
