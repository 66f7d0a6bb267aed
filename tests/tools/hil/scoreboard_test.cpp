// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/scoreboard.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tools/hil/bench.h"

namespace sandrunner::hil {
namespace {

constexpr double kCycle_s = 0.25, kWalkKp = 60.0;
using Drives = JointArray<DriveMoment>;

Drives drives(double kp_nmprad, double torque_nm = 0.0) {
  Drives drives;
  drives.fill({.on = true,
               .off = false,
               .passive = kp_nmprad == 0.0,
               .limp = false,
               .kp_nmprad = kp_nmprad,
               .torque_nm = torque_nm});
  return drives;
}

TEST(ScoreboardTest, MeasuresTheSecondHalfOfTheWalk) {
  Scoreboard board(kCycle_s, 1.0, kWalkKp, {});
  board.note(0.0, Drives(), {}, true);  // lies, off
  board.note(0.25, drives(100.0), {}, true);
  EXPECT_FALSE(board.score().mean_speed_mps);
  EXPECT_NE(std::string(board.score().why_no_speed()).find("never had the policy's gains"),
            std::string::npos);
  // Four cycles are judged: those at 0.1, 0.2, 0.4 and 0.7 m.
  for (const double x_m : {0.1, 0.2, 0.4, 0.7, 3.0}) {
    board.note(1.0, drives(kWalkKp), {x_m, 0.0}, false);
  }
  const Score score = board.score();
  EXPECT_EQ(score.enabled_at_s, 0.25);
  EXPECT_NEAR(*score.mean_speed_mps, (0.7 - 0.4) / kCycle_s, 1e-12);
  EXPECT_EQ(score.why_no_speed(), nullptr);
  EXPECT_NEAR(score.walked_s, 5 * kCycle_s, 1e-12);
  EXPECT_NEAR(score.distance_m, 3.0, 1e-12);
  EXPECT_FALSE(score.base_touched);
  EXPECT_FALSE(score.off_at_end);
}

TEST(ScoreboardTest, TellsDampedFromPassiveFromLimp) {
  Scoreboard board(kCycle_s, 0.0, kWalkKp, {});
  board.note(0.0, drives(100.0, 5.0), {}, false);
  board.fault_made("1 silent LF_HAA", 1.0);
  board.note(1.0, drives(100.0, -7.0), {}, false);
  Drives moment = drives(0.0, 2.0);  // one hears nothing, and holds its last command
  moment[0] = {.on = true, .off = false, .reachable = false, .passive = false, .limp = false};
  board.note(1.5, moment, {}, false);
  board.note(2.0, drives(0.0, 1.0), {}, false);
  FaultFigures figures = board.score().faults.at(0);
  EXPECT_EQ(figures.damped_after_s, 0.5);
  EXPECT_EQ(figures.passive_after_s, 1.0);
  EXPECT_FALSE(figures.limp_after_s);
  EXPECT_EQ(figures.largest_torque_nm, 7.0);
  board.note(3.0, Drives(), {}, false);
  board.note(4.0, drives(100.0, 50.0), {}, false);
  figures = board.score().faults.at(0);
  EXPECT_EQ(figures.limp_after_s, 2.0);
  EXPECT_EQ(figures.largest_torque_nm, 7.0);
}

TEST(BenchReportTest, AFigureThatIsNullHasItsReason) {
  BenchReport report;
  report.score.faults.emplace_back().damped_after_s = 0.5;
  const auto json = nlohmann::json::parse(report_json(report));
  EXPECT_TRUE(json.at("walk").at("mean_speed_mps").is_null());
  EXPECT_EQ(json.at("walk").at("why_null"), "the drives were never all on");
  EXPECT_TRUE(json.at("faults").at(0).at("limp_after_s").is_null());
  EXPECT_EQ(json.at("faults").at(0).at("why_null"), "not until the end");
}

}  // namespace
}  // namespace sandrunner::hil
