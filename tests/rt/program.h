// SPDX-License-Identifier: BSD-3-Clause
// The program sandrunner, run as a user runs it.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <set>
#include <string>

#include "tests/support/temporary_folder.h"

namespace sandrunner {

class ProgramTest : public testing::Test {
 protected:
  /// Runs the program in the working folder and returns its exit code.
  int run(const std::string& arguments) {
    // The leak check of the sanitizers otherwise lists what it was told to pass over.
    const std::string command = "cd '" + folder_.path("") +
                                "' && LSAN_OPTIONS=print_suppressions=0 '" SANDRUNNER_PROGRAM "' " +
                                arguments + " >'" + captured_.path("out") + "' 2>'" +
                                captured_.path("err") + "'";
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string output() const { return read_file(captured_.path("out")); }
  std::string error() const { return read_file(captured_.path("err")); }
  /// The state hash that the table shows.
  std::string printed_hash() const {
    const std::string text = output(), label = "state hash";
    const std::size_t at = text.find_first_not_of(' ', text.find(label) + label.size());
    return text.substr(at, text.find('\n', at) - at);
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

  const TemporaryFolder folder_;    ///< the working folder
  const TemporaryFolder captured_;  ///< what the program printed
};

}  // namespace sandrunner
