// SPDX-License-Identifier: BSD-3-Clause
// Tests in real time, on computers that hold a thread up now and then.
#pragma once

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>

namespace sandrunner {

/// Whether a run that printed this was rightly ended because a thread of it did not run for 30 ms,
/// or its control thread for 100 ms while its watchdog did.
inline bool stalled(const std::string& printed) {
  for (const char* fault : {"loop_stalled", "policy_stale", "drives_cut"}) {
    if (printed.find(fault) != std::string::npos) return true;
  }
  return false;
}

/// Does `attempt`, which is to set `said` to what its run said at the end, even if an assertion
/// ends it; anew where an assertion in it failed and this computer stalled, whose failures then do
/// not count. (An attempt whose run is judged afterwards expects that it did not stall.) Ten in a
/// row are no chance.
inline void unless_stalled(const std::function<void(std::string& said)>& attempt) {
  for (int left = 9;; --left) {
    std::string said;
    testing::TestPartResultArray results;
    {
      const testing::ScopedFakeTestPartResultReporter reporter(
          testing::ScopedFakeTestPartResultReporter::INTERCEPT_ONLY_CURRENT_THREAD, &results);
      attempt(said);
    }
    bool failed = false;
    for (int i = 0; i < results.size(); ++i) {
      const testing::TestPartResult& result = results.GetTestPartResult(i);
      if (!result.failed()) continue;
      failed = true;
      if (left > 0 && stalled(said)) break;
      ADD_FAILURE_AT(result.file_name(), result.line_number()) << result.message();
    }
    if (!failed || left == 0 || !stalled(said)) return;
  }
}

}  // namespace sandrunner
