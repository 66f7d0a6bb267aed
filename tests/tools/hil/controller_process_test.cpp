// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/controller_process.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "rt/base/output_files.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner::hil {
namespace {

int exit_code(ControllerProcess& process) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (std::chrono::steady_clock::now() < deadline) {
    if (const auto code = process.ended()) return *code;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return -2;
}

TEST(ControllerProcessTest, FindsAProgramByAPathFromTheCallersFolder) {
  const TemporaryFolder folder;
  write_file(folder.path("program"), "#!/bin/sh\nexit 7\n");
  chmod(folder.path("program").c_str(), 0700);
  std::filesystem::create_directory(folder.path("run"));
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path(""));
  ControllerProcess process({"./program"}, folder.path("run"));
  std::filesystem::current_path(before);
  EXPECT_EQ(exit_code(process), 7);
}

}  // namespace
}  // namespace sandrunner::hil
