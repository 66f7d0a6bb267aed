// SPDX-License-Identifier: BSD-3-Clause
// Programs run as a user runs them: in a shell, in a folder.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>

#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {

class ProgramTest : public testing::Test {
 protected:
  /// `program`: its path, which `run` runs.
  explicit ProgramTest(const std::string& program) : program_("'" + program + "' ") {}

  /// Runs the program in the folder, with arguments as the shell reads them; returns its exit code.
  int run(const std::string& arguments) { return run_line(program_ + arguments); }
  int run_line(const std::string& line) {
    ended_ = run_shell(line, {.folder = folder_.path("")});
    return ended_.code;
  }
  /// Of the last run: standard output, standard error.
  const std::string& output() const { return ended_.out; }
  const std::string& error() const { return ended_.err; }

  /// Bad input: exit code 2, nothing but one line on standard error that names the cause.
  void expect_refused(const std::string& arguments, const std::string& cause) {
    EXPECT_EQ(run(arguments), 2) << arguments;
    EXPECT_EQ(output(), "") << arguments;
    EXPECT_EQ(std::count(error().begin(), error().end(), '\n'), 1) << arguments << "\n" << error();
    EXPECT_NE(error().find(cause), std::string::npos) << "no '" << cause << "' in: " << error();
  }
  /// Names of all that lies in a folder below the working folder, with what lies below.
  std::set<std::string> files_in(const std::string& folder) const {
    std::set<std::string> names;
    const std::filesystem::path root = folder_.path(folder);
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
      names.insert(entry.path().lexically_relative(root).string());
    }
    return names;
  }

  const TemporaryFolder folder_;  ///< the working folder

 private:
  const std::string program_;
  Ended ended_;
};

}  // namespace sandrunner
