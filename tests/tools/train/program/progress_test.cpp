// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/progress.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace sandrunner::train {
namespace {

TEST(ProgressTest, ARobotOfAnyNameHasACurveThatAPageCanRead) {
  Progress progress;
  progress.add({});
  const std::string title = "Training of \"my\\robot\"\n";
  EXPECT_EQ(nlohmann::json::parse(progress.page_json(title)).at("title"), title);
}

TEST(ProgressTest, AFigureThatWasNeverMeasuredHasNoChart) {
  const auto charts_of_asymmetry = [](double value) {
    Progress progress;
    ProgressRow row{};
    row.asymmetry = value;
    progress.add(row);
    const auto page = nlohmann::json::parse(progress.page_json("Training"));
    return std::ranges::count(page.at("charts"), "asymmetry",
                              [](const nlohmann::json& chart) { return chart.at("title"); });
  };
  EXPECT_EQ(charts_of_asymmetry(0.1), 1);
  EXPECT_EQ(charts_of_asymmetry(std::nan("")), 0);
}

}  // namespace
}  // namespace sandrunner::train
