// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/simulated/grid_run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "policy/policy_file.h"
#include "tests/support/not_finite.h"
#include "tools/train/task/robot_settings.h"

namespace sandrunner::study {
namespace {

TEST(GridCellsTest, AreThePapersCells) {
  const std::vector<GridCell> cells = grid_cells(10);
  ASSERT_EQ(cells.size(), 100u);
  EXPECT_EQ(cells[0].sigma_flat_npm3, 1.0e6);
  EXPECT_EQ(cells[0].sigma_cone_npm3, 0.15e6);
  EXPECT_DOUBLE_EQ(cells[1].sigma_cone_npm3, 0.20e6);
  EXPECT_DOUBLE_EQ(cells[10].sigma_flat_npm3, 2.0e6);
  EXPECT_EQ(cells[99].sigma_flat_npm3, 10.0e6);
  EXPECT_EQ(cells[99].sigma_cone_npm3, 0.6e6);
}

TEST(ClearanceTest, IsTheMeanHeightAboveTheMeanDepthOfTheStances) {
  ClearanceSums sums;
  // One foot stands twice, 20 and 40 mm deep; three stay 100 mm up and unloaded.
  for (const double height_m : {0.06, -0.01, -0.02, 0.06, -0.04, 0.06}) {
    sums.add({height_m, 0.1, 0.1, 0.1}, {height_m < 0.0, false, false, false});
  }
  const double mean_height_m = (0.11 + 6 * 0.3) / 24.0;
  EXPECT_NEAR(sums.clearance_m(), mean_height_m + 0.03, 1e-12);
}

TEST(ClearanceTest, AStanceThatLastsCountsAndAFootAboveTheGroundHasNone) {
  ClearanceSums sums;
  EXPECT_TRUE(std::isnan(sums.clearance_m()));
  sums.add({0.02, 0.02, 0.02, 0.02}, {true, true, true, true});  // as at the start, in the air
  EXPECT_TRUE(std::isnan(sums.clearance_m()));
  sums.add({-0.02, -0.02, -0.02, -0.02}, {true, true, true, true});
  EXPECT_NEAR(sums.clearance_m(), 0.0 + 0.02, 1e-12);
}

TEST(SlopesTest, AreThoseOfAPlaneAlsoWithGaps) {
  std::vector<double> a, b, y;
  for (int i = 0; i < 12; ++i) {
    const int column = i % 3, row = i / 3;
    a.push_back(column);
    b.push_back(row + 0.2 * column);
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

TEST(StaticDepthTest, GrowsOnSofterGroundAndBearsAQuarterOfTheRobot) {
  const sim::Robot robot = sim::load_raibo();
  EXPECT_GT(static_depth_m(robot, {1e6, 0.15e6}), static_depth_m(robot, {2e6, 0.15e6}));
  EXPECT_GT(static_depth_m(robot, {1e6, 0.15e6}), static_depth_m(robot, {1e6, 0.2e6}));
  // On a wide plate the force would be sigma A z: 66 N on at most 40 cm^2.
  EXPECT_GT(static_depth_m(robot, {10e6, 0.6e6}), 66.0 / (10e6 * 40e-4));
}

class GridRunTest : public testing::Test {
 protected:
  std::vector<GridRobot> run(const GridCell& cell, int robots, int threads) const {
    WorkerPool pool(threads);
    return run_cell(network_, cell, robots, robot_, pool);
  }
  const sim::Robot robot_ = sim::load_raibo();
  const train::TaskNetwork network_ =
      train::make_task_network(parse_policy_file(shipped_policy_text(), "the shipped policy"),
                               train::shipped_task_config(robot_).policy.mode_gain);
};

TEST_F(GridRunTest, IsTheSameForAnyThreadsAndNumberOfRobots) {
  const GridCell cell{3e6, 0.3e6};
  const std::vector<GridRobot> all = run(cell, 20, 2), some = run(cell, 7, 1);
  ASSERT_EQ(all.size(), 20u);
  ASSERT_EQ(some.size(), 7u);
  for (std::size_t i = 0; i < some.size(); ++i) {
    EXPECT_EQ(all[i].reward, some[i].reward) << i;
    EXPECT_EQ(all[i].clearance_m, some[i].clearance_m) << i;
  }
}

TEST_F(GridRunTest, EveryCellAndNetworkHasTheSameCommandsAndItsOwnGround) {
  const auto start = [&](const GridCell& cell) {
    const train::TaskConfig config = grid_task(robot_, cell);
    train::Task task(config, robot_, {16, 16}, 7);
    task.set_curriculum({config.command.speed_max_mps, 1.0}, 1e12, 1.0);
    task.restart(7);
    return task;
  };
  const train::Task soft = start({1e6, 0.15e6}), stiff = start({10e6, 0.6e6});
  float fastest = 0.0f;
  for (int env = 0; env < 16; ++env) {
    EXPECT_EQ(soft.command(env), stiff.command(env));
    EXPECT_EQ(soft.batch().state(env).rigid.q, stiff.batch().state(env).rigid.q);
    EXPECT_FLOAT_EQ(soft.terrain(env).ground[0].sigma_flat, 1e6f);
    EXPECT_FLOAT_EQ(stiff.terrain(env).ground[0].sigma_cone, 0.6e6f);
    EXPECT_FLOAT_EQ(soft.terrain(env).ground[0].stroke_stiffness, 160.0f);
    fastest = std::fmax(fastest, soft.command(env)[0]);
  }
  EXPECT_GT(fastest, 2.0f);
  EXPECT_LE(fastest, 3.0f);
}

TEST_F(GridRunTest, ARobotThatFallsHasNoClearanceAndLosesReward) {
  train::TaskNetwork limp = network_;
  for (float& weight : limp.parameters) weight *= 3.0f;  // it flails
  WorkerPool pool(1);
  int fell = 0;
  for (const GridRobot& r : run_cell(limp, {1e6, 0.15e6}, 16, robot_, pool)) {
    fell += r.fell;
    EXPECT_EQ(r.fell, std::isnan(r.clearance_m));
    if (r.fell) {
      EXPECT_LT(r.reward, 1.0);
    }
  }
  EXPECT_GT(fell, 8);
}

}  // namespace
}  // namespace sandrunner::study
