// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/evidence/grid_evidence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "policy/policy_file.h"
#include "rt/base/output_files.h"
#include "tests/support/temporary_folder.h"
#include "tools/study/experiments/experiments.h"

namespace sandrunner::study {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(SlopesTest, AreThoseOfAPlaneAlsoWithGaps) {
  std::vector<double> a, b, y;
  for (int i = 0; i < 12; ++i) {
    a.push_back(i % 3);
    b.push_back(i / 3 + 0.2 * (i % 3));
    y.push_back(i == 5 ? kNan : 7.0 - 0.3 * a.back() + 0.1 * b.back());
  }
  const Slopes slopes = fit_slopes(a, b, y);
  EXPECT_NEAR(slopes.a, -0.3, 1e-12);
  EXPECT_NEAR(slopes.b, 0.1, 1e-12);
}

TEST(SlopesTest, AreNotDefinedOnALine) {
  EXPECT_TRUE(std::isnan(fit_slopes({0, 1, 2}, {5, 5, 5}, {1, 2, 3}).a));
  EXPECT_TRUE(std::isnan(fit_slopes({0, 1, 2}, {0, 0, 1}, {kNan, kNan, kNan}).b));
}

Measured cells(const std::vector<double>& depth, const std::vector<double>& reward) {
  return {{{kGridGround, kGridCells, 0.0, {}, {{"static_depth_m", depth}, {"reward", reward}}}}};
}

TEST(SoftAndStiffTest, AreQuartersByStaticDepth) {
  const SoftAndStiff mean =
      soft_and_stiff(cells({3, 1, 8, 4, 5, 6, 7, 2}, {0, 4, 1, 0, 0, 0, 3, 6}), "reward");
  EXPECT_EQ(mean.soft, 2.0);
  EXPECT_EQ(mean.stiff, 5.0);
}

TEST(GridMediansTest, AreOfTheSeedsThatHaveTheCell) {
  Evidence evidence;
  EXPECT_TRUE(grid_medians(evidence, "ours", "reward").empty());
  evidence.measured["E7"]["ours"] = {
      {1, cells({1, 2}, {1, kNan})}, {2, cells({1, 2}, {3, 5})}, {3, cells({1, 2}, {7, kNan})}};
  EXPECT_EQ(grid_medians(evidence, "ours", "reward"), (std::vector<double>{3, 5}));
}

class GridExperimentTest : public testing::Test {
 protected:
  GridExperimentTest() {
    write_file(folder_.path("ours-1.safetensors"), shipped_policy_text());
    models_ = load_models(folder_.path(""), {}, sim::load_raibo());
  }
  const TemporaryFolder folder_;
  std::vector<Model> models_;
};

TEST_F(GridExperimentTest, YieldsEachCellAndEachRobot) {
  Lab lab({.grid_runs = 16, .grid_cells = 2});
  const Measured measured = run_grid(lab, models_.at(0));
  for (const char* name :
       {"sigma_flat_npm3", "static_depth_m", "success", "reward", "clearance_m"}) {
    EXPECT_EQ(grid_list(measured, name).size(), 4u) << name;
  }
  const RunGroup& robots = *measured.select(kGridGround, kGridRobots).at(0);
  EXPECT_EQ(robots.size(), 16u);
  // The shipped policy's mean over the cells is that over the robots.
  EXPECT_NEAR(mean_of(robots.values("reward")), mean_of(grid_list(measured, "reward")), 1e-9);
  EXPECT_GT(mean_of(robots.values("success")), 0.8);
  EXPECT_LT(mean_of(robots.values("slope_flat_m")),
            0.0);  // it lifts its feet higher on soft ground
}

TEST_F(GridExperimentTest, AControllerThatSeesTheGroundIsJudgedOnItsOwnGround) {
  Lab lab({.runs = 3});
  models_.at(0).controller = find_controller("oracle-h");
  models_.at(0).subject.reset();
  const Measured measured = run_fairness(lab, models_.at(0));
  ASSERT_EQ(measured.groups.size(), 3u);
  for (const RunGroup& group : measured.groups) {
    EXPECT_EQ(group.values("alive"), (std::vector<double>{1, 1, 1})) << group.command;
  }
}

}  // namespace
}  // namespace sandrunner::study
