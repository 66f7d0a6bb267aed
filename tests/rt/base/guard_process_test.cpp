// SPDX-License-Identifier: BSD-3-Clause
// In a child process (death test): the test keeps its own name.
#include "rt/base/guard_process.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <string>

#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

TEST(ProcessNameDeathTest, NothingOfTheProgramsNameIsLeft) {
  const auto child = [] {
    rename_process("legs-guard");
    if (read_file("/proc/self/comm") != "legs-guard\n") _exit(1);
    const std::string line = read_file("/proc/self/cmdline");
    if (std::string(line.c_str()) != "legs-guard") _exit(2);
    _exit(line.find_first_not_of('\0', 10) == std::string::npos ? 0 : 3);
  };
  EXPECT_EXIT(child(), testing::ExitedWithCode(0), "");
}

TEST(ProcessNameDeathTest, ALongNameIsCutToWhatTheKernelKeeps) {
  const auto child = [] {
    rename_process(std::string(100'000, 'x').c_str());
    if (read_file("/proc/self/comm") != std::string(15, 'x') + "\n") _exit(1);
    _exit(read_file("/proc/self/cmdline").starts_with("xxx") ? 0 : 2);
  };
  EXPECT_EXIT(child(), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace sandrunner
