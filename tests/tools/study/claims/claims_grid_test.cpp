// SPDX-License-Identifier: BSD-3-Clause
// Verdicts of the claims about the grid, on made-up measurements.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>

#include "tools/study/claims/claims.h"
#include "tools/study/evidence/grid_evidence.h"

namespace sandrunner::study {
namespace {

// A controller with this mean reward on the stiffest three quarters of the cells, ...
struct GridFigures {
  double reward = 4.0;
  double lost = 0.1;          // ... this share less on the softest quarter, ...
  double slope_m = -0.020;    // ... these slopes of clearance, the same for both stiffnesses, ...
  double clearance_m = 0.03;  // ... and this clearance everywhere
  int lower_cells = 0;        // of the cells, those with 1 less reward and 10 mm less clearance
  int cells = 100;
  double slope_spread_m = 0.001;  // between robots
};

Measured on_grid(const GridFigures& m) {
  constexpr int kRobots = 16;
  RunGroup cells{kGridGround, kGridCells, 0.0, {}, {}};
  for (int i = 0; i < m.cells; ++i) {
    const bool soft = i < m.cells / 4, lower = i < m.lower_cells;
    cells.lists["static_depth_m"].push_back(0.05 - 1e-4 * i);
    cells.lists["reward"].push_back(m.reward * (soft ? 1.0 - m.lost : 1.0) - lower);
    cells.lists["clearance_m"].push_back(m.clearance_m - 0.01 * lower);
  }
  RunGroup robots{kGridGround, kGridRobots, 0.0, {}, {}};
  for (int i = 0; i < kRobots; ++i) {
    const double side = i % 2 == 0 ? 1.0 : -1.0;
    robots.runs["reward"].push_back(m.reward + 0.5 * side);
    robots.runs["slope_flat_m"].push_back(m.slope_m + m.slope_spread_m * side);
    robots.runs["slope_cone_m"].push_back(m.slope_m + m.slope_spread_m * side);
  }
  return {{cells, robots}};
}

Measured alive_at_home(int runs) {
  Measured measured;
  for (const double command : {1.0, 2.0, 3.0}) {
    RunGroup group{"own", "", command, {}, {}};
    for (int i = 0; i < 16; ++i) group.runs["alive"].push_back(i < runs);
    measured.groups.push_back(group);
  }
  return measured;
}

using GridControllers = std::map<std::string, GridFigures>;

std::string grid_verdict(const std::string& id, const GridControllers& all, int runs_alive = 16) {
  Evidence evidence;
  for (const auto& [controller, figures] : all) {
    for (const int seed : {1, 2}) {
      evidence.measured["E7"][controller][seed] = on_grid(figures);
      evidence.measured["fairness"][controller][seed] = alive_at_home(runs_alive);
    }
  }
  const auto found =
      std::find_if(claims().begin(), claims().end(), [&](const Claim& c) { return c.id == id; });
  if (found == claims().end()) throw std::logic_error("no claim " + id);
  return judgement_text(judge(*found, evidence));
}

TEST(GridClaimsTest, RewardIsLostOnSoftGround) {
  const auto with = [](double rigid, double pl_rigid) {
    return grid_verdict("52", {{"ours", {.lost = 0.1}},
                               {"env-rigid", {.lost = rigid}},
                               {"pl-rigid", {.lost = pl_rigid}}});
  };
  EXPECT_EQ(with(0.5, 0.41), "agrees");
  EXPECT_EQ(with(0.5, 0.35), "can't tell");
  EXPECT_EQ(with(0.5, 0.05), "can't tell");
  EXPECT_EQ(with(0.05, 0.1), "contradicts");
}

TEST(GridClaimsTest, ClearanceOfTheRigidOnesAdaptsLess) {
  const auto with = [](double rigid_m, double pl_rigid_m) {
    return grid_verdict("53", {{"ours", {.slope_m = -0.02}},
                               {"env-rigid", {.slope_m = rigid_m}},
                               {"pl-rigid", {.slope_m = pl_rigid_m}}});
  };
  EXPECT_EQ(with(-0.009, 0.009), "agrees");
  EXPECT_EQ(with(-0.009, -0.015), "can't tell");
  EXPECT_EQ(with(-0.03, -0.025), "contradicts");
}

TEST(GridClaimsTest, ClearanceOfTheTcnAdaptsLess) {
  const auto with = [](double tcn_m) {
    return grid_verdict("58", {{"ours", {.slope_m = -0.02}}, {"tcn", {.slope_m = tcn_m}}});
  };
  EXPECT_EQ(with(-0.009), "agrees");
  EXPECT_EQ(with(-0.015), "can't tell");
  EXPECT_EQ(with(-0.021), "contradicts");
}

TEST(GridClaimsTest, ClearanceAdaptsIfItIsHigherOnSofterGround) {
  const auto with = [](const GridFigures& pl) {
    return grid_verdict("54", {{"ours", {.slope_m = -0.02}}, {"pl-gm", pl}});
  };
  EXPECT_EQ(with({.slope_m = -0.006}), "agrees");
  EXPECT_EQ(with({.slope_m = -0.004}), "can't tell");
  EXPECT_EQ(with({.slope_m = 0.006}), "can't tell");
  EXPECT_EQ(with({.slope_m = -0.006, .slope_spread_m = 0.1}), "contradicts");
}

TEST(GridClaimsTest, CellsAreCounted) {
  const auto with = [](int better) {
    // Ours is the same everywhere.
    return grid_verdict("55", {{"ours", {.reward = 3.5, .lost = 0.0}},
                               {"pl-gm", {.reward = 4.0, .lost = 0.0, .lower_cells = better}}});
  };
  EXPECT_EQ(with(95), "agrees");
  EXPECT_EQ(with(94), "can't tell");
  EXPECT_EQ(with(50), "can't tell");
  EXPECT_EQ(with(49), "contradicts");
  const auto lower = [](int cells) {
    return grid_verdict("56", {{"ours", {.lower_cells = cells}}, {"pl-gm", {}}});
  };
  EXPECT_EQ(lower(95), "agrees");
  EXPECT_EQ(lower(60), "can't tell");
  EXPECT_EQ(lower(10), "contradicts");
}

TEST(GridClaimsTest, AGridOfAnotherSizeTellsNothingOfItsCells) {
  const GridControllers all = {{"ours", {.reward = 5.0, .cells = 4}},
                               {"pl-gm", {.reward = 4.0, .cells = 4}},
                               {"env-rigid", {.lost = 0.9, .cells = 4}},
                               {"pl-rigid", {.lost = 0.9, .cells = 4}},
                               {"tcn", {.slope_m = 0.0, .cells = 4}}};
  for (const char* id : {"52", "53", "54", "55", "56", "58"}) {
    EXPECT_EQ(grid_verdict(id, all), "can't tell (not run)") << id;
  }
}

TEST(GridClaimsTest, TheRecurrentOneHasMoreReward) {
  EXPECT_EQ(grid_verdict("57", {{"ours", {.reward = 4.1}}, {"tcn", {.reward = 4.0}}}), "agrees");
  EXPECT_EQ(grid_verdict("57", {{"ours", {.reward = 4.0}}, {"tcn", {.reward = 4.0}}}),
            "can't tell");
  EXPECT_EQ(grid_verdict("57", {{"ours", {.reward = 4.0}}, {"tcn", {.reward = 4.1}}}),
            "contradicts");
  EXPECT_EQ(grid_verdict("57", {{"ours", {}}}), "can't tell (not run)");
}

TEST(GridClaimsTest, TheTeacherIsBelowThreeOthers) {
  const auto with = [](double ours, double oracle_h, double oracle_o) {
    return grid_verdict("60", {{"teacher-gm", {.reward = 4.0}},
                               {"ours", {.reward = ours}},
                               {"oracle-h", {.reward = oracle_h}},
                               {"oracle-o", {.reward = oracle_o}}});
  };
  EXPECT_EQ(with(4.1, 4.2, 4.1), "agrees");
  EXPECT_EQ(with(4.1, 4.2, 4.0), "can't tell");
  EXPECT_EQ(with(4.1, 4.2, 3.9), "contradicts");
}

TEST(GridClaimsTest, OneOracleIsTheBestOfAll) {
  const auto with = [](double oracle_h, double tcn, int runs_alive = 16) {
    GridControllers all;
    for (const char* controller : grid_controllers()) all[controller] = {.reward = 4.0};
    all["oracle-h"].reward = oracle_h;
    all["tcn"].reward = tcn;
    return grid_verdict("61", all, runs_alive);
  };
  EXPECT_EQ(with(4.2, 4.0), "agrees");
  EXPECT_EQ(with(4.1, 4.0), "can't tell");  // 2.5 % above
  EXPECT_EQ(with(4.2, 4.3), "can't tell");
  EXPECT_EQ(with(3.9, 4.0), "contradicts");
  EXPECT_EQ(with(4.2, 4.0, 14), "can't tell (not competently trained)");
}

TEST(GridClaimsTest, TheOtherOracleIsLikeOurs) {
  const auto with = [](double oracle_o) {
    return grid_verdict("62", {{"ours", {.reward = 4.0}}, {"oracle-o", {.reward = oracle_o}}});
  };
  EXPECT_EQ(with(4.1), "agrees");
  EXPECT_EQ(with(3.8), "can't tell");
  EXPECT_EQ(with(4.3), "contradicts");
}

TEST(GridClaimsTest, TheStudentIsBelowItsTeacher) {
  const auto with = [](double student) {
    return grid_verdict("68", {{"pl-gm", {.reward = student}}, {"teacher-gm", {.reward = 4.0}}});
  };
  EXPECT_EQ(with(4.0), "agrees");
  EXPECT_EQ(with(4.1), "contradicts");
}

}  // namespace
}  // namespace sandrunner::study
