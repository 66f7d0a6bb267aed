// SPDX-License-Identifier: BSD-3-Clause
// E7, and the fairness of controllers that see the ground.
#include <gtest/gtest.h>

#include "policy/policy_file.h"
#include "rt/base/output_files.h"
#include "tests/support/temporary_folder.h"
#include "tools/study/experiments/experiments.h"

namespace sandrunner::study {
namespace {

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
    EXPECT_EQ(measured.groups.at(0).lists.at(name).size(), 4u) << name;
  }
  const RunGroup& robots = measured.groups.at(1);
  EXPECT_EQ(robots.runs.at("reward").size(), 16u);
  // The shipped policy's mean over the cells is that over the robots.
  EXPECT_NEAR(mean_of(robots.runs.at("reward")), mean_of(measured.groups[0].lists.at("reward")),
              1e-9);
  EXPECT_GT(mean_of(robots.runs.at("success")), 0.8);
  EXPECT_LT(mean_of(robots.runs.at("slope_flat_m")),
            0.0);  // it lifts its feet higher on soft ground
}

TEST_F(GridExperimentTest, AControllerThatSeesTheGroundIsJudgedOnItsOwnGround) {
  Lab lab({.runs = 3});
  models_.at(0).controller = find_controller("oracle-h");
  models_.at(0).policy.reset();
  const Measured measured = run_fairness(lab, models_.at(0));
  ASSERT_EQ(measured.groups.size(), 3u);
  for (const RunGroup& group : measured.groups) {
    EXPECT_EQ(group.runs.at("alive"), (std::vector<double>{1, 1, 1})) << group.command;
  }
}

}  // namespace
}  // namespace sandrunner::study
