// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/input_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <string>

#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

TEST(InputFileTest, BytesComeBackAsTheyAre) {
  const TemporaryFolder folder;
  const std::string bytes("text\r\n\0\xff", 8);
  write_file(folder.path("file"), bytes);
  EXPECT_EQ(read_input_file(folder.path("file"), "a list"), bytes);
  // The system says that this one has 0 bytes.
  EXPECT_NE(read_input_file("/proc/self/status", "a list"), "");
}

TEST(InputFileTest, WhatIsNoRegularFileIsRefused) {
  const TemporaryFolder folder;
  const std::string absent = folder.path("absent"), pipe = folder.path("pipe");
  EXPECT_EQ(error_of([&] { read_input_file(absent, "a list"); }),
            absent + ": cannot be read (No such file or directory), expected a list");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& path : {folder.path(""), std::string("/dev/zero"), pipe}) {
    EXPECT_EQ(error_of([&] { read_input_file(path, "a list"); }),
              path + ": cannot be read (not a regular file), expected a list");
  }
}

TEST(InputFileTest, AHugeFileIsRefused) {
  const TemporaryFolder folder;
  const std::string path = folder.path("huge");
  write_file(path, "");
  std::filesystem::resize_file(path, kLargestInputFile_bytes);
  EXPECT_EQ(read_input_file(path, "a list").size(), kLargestInputFile_bytes);
  std::filesystem::resize_file(path, kLargestInputFile_bytes + 1);
  EXPECT_EQ(error_of([&] { read_input_file(path, "a list"); }),
            path + ": cannot be read (more than 67108864 bytes), expected a list");
}

}  // namespace
}  // namespace sandrunner
