// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/progress.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace sandrunner::train {
namespace {

TEST(ProgressTest, ARobotOfAnyNameHasACurveThatAPageCanRead) {
  Progress progress;
  progress.add({});
  const std::string title = "Training of \"my\\robot\"\n";
  EXPECT_EQ(nlohmann::json::parse(progress.page_json(title)).at("title"), title);
}

}  // namespace
}  // namespace sandrunner::train
