// SPDX-License-Identifier: BSD-3-Clause
#include "rt/report/row_maker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/rt/telemetry/example_tick.h"

namespace sandrunner {
namespace {

/// A tick of a robot that tells its truth and stands with its feet on the surface.
TickRecord true_tick(std::uint64_t number) {
  TickRecord tick = example_tick(number);
  tick.has_truth = 1;
  tick.truth.position_m = {1.0 + 1e-4 * static_cast<double>(number), 2.0, 0.5};
  tick.truth.velocity_mps = {0.8, 0.1, 0.0};
  tick.truth.joint_torque_nm = all_joints(3.0);
  tick.before.joint_velocity_radps = all_joints(2.0);
  tick.truth.joint_velocity_radps = all_joints(5.0);
  tick.before.state.body_height_m = 0.45;
  return tick;
}

std::vector<RunRow> rows_of(RowMaker& maker, std::uint64_t first, std::uint64_t last,
                            const auto& change) {
  std::vector<RunRow> rows;
  for (std::uint64_t i = first; i <= last; ++i) {
    TickRecord tick = true_tick(i);
    change(tick);
    if (const auto row = maker.add(tick)) rows.push_back(*row);
  }
  return rows;
}

void unchanged(TickRecord&) {}

TEST(RowMakerTest, ARowComesWithTheAnswerToItsOwnSensors) {
  const RunScene scene{.robot = example_robot()};
  RowMaker maker(scene);
  std::optional<RunRow> row;
  for (std::uint64_t i = 0; i < 40; ++i) EXPECT_FALSE(maker.add(true_tick(i)));
  TickRecord next = true_tick(40);
  EXPECT_TRUE(maker.add(next));  // the one of tick 0 was never answered
  next = true_tick(41);
  next.input.policy.sequence = 6;
  next.input.policy.input_tick = 40;
  row = maker.add(next);
  ASSERT_TRUE(row);
  EXPECT_EQ(row->t_s, 0.01);
  EXPECT_EQ(row->flags, kRowHasTruth | kRowHasEstimate);
  EXPECT_FLOAT_EQ(row->estimate[0], 0.45f);
  EXPECT_FLOAT_EQ(row->estimate[1], 0.8f);
  EXPECT_FLOAT_EQ(row->truth[0], 0.45f);
  EXPECT_DOUBLE_EQ(row->position_m[0], 1.004);
}

TEST(RowMakerTest, AnUnansweredRowHasNoEstimate) {
  const RunScene scene{.robot = example_robot()};
  RowMaker maker(scene);
  const auto rows = rows_of(maker, 0, 40, unchanged);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].flags, kRowHasTruth);
  EXPECT_TRUE(std::isnan(rows[0].estimate[0]));
  EXPECT_TRUE(maker.take_last());
  EXPECT_FALSE(maker.take_last());
}

TEST(RowMakerTest, PeaksAndMeansAreOfTheTicksSinceTheRowBefore) {
  const RunScene scene{.robot = example_robot()};
  RowMaker maker(scene);
  const auto rows = rows_of(maker, 0, 120, [](TickRecord& tick) {
    if (tick.input.sensors.tick == 55) tick.truth.joint_torque_nm[4] = -40.0;
    if (tick.input.sensors.tick == 60) tick.timing.late_ns = 90'000;
    tick.skipped = tick.input.sensors.tick == 70 ? 2 : 0;
  });
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[1].peak_torque_nm[4], 3.0f);
  EXPECT_EQ(rows[2].peak_torque_nm[4], -40.0f);
  EXPECT_EQ(rows[2].peak_torque_nm[5], 3.0f);
  EXPECT_FLOAT_EQ(rows[1].power_w, 12 * 3.0f * 2.0f);
  EXPECT_FLOAT_EQ(rows[1].torque_squared_nm2, 12 * 9.0f);
  EXPECT_FLOAT_EQ(rows[1].late_us, 2.0f);
  EXPECT_FLOAT_EQ(rows[2].late_us, 90.0f);
  EXPECT_FLOAT_EQ(rows[2].tick_us, 12.0f);
  EXPECT_EQ(rows[1].skipped, 0u);
  EXPECT_EQ(rows[2].skipped, 2u);
}

TEST(RowMakerTest, AFootprintIsWhereTheFootWasDeepestInAStance) {
  const RunScene scene{.robot = example_robot()};
  RowMaker maker(scene);
  const auto rows = rows_of(maker, 0, 200, [](TickRecord& tick) {
    const double t = static_cast<double>(tick.input.sensors.tick);
    tick.truth.foot_penetration_m.fill(-0.1);
    // Leg 2 is in the ground from tick 50 to 150, deepest at 100. Leg 3 only touches it.
    if (t >= 50 && t <= 150) tick.truth.foot_penetration_m[2] = 0.05 - 1e-3 * std::abs(t - 100.0);
    if (t >= 50 && t <= 60) tick.truth.foot_penetration_m[3] = 0.04;
    tick.truth.foot_centre_m[2] = {1e-3 * t, -2e-3 * t, 0.0};
  });
  EXPECT_EQ(rows[1].stance_m[2][2], 0.0f);  // tick 40
  EXPECT_FLOAT_EQ(rows[2].stance_m[2][2], 0.03f);
  EXPECT_FLOAT_EQ(rows[3].stance_m[2][0], 0.1f);  // tick 120: deepest at 100
  const auto prints = maker.take_footprints();
  ASSERT_EQ(prints.size(), 1u);
  EXPECT_EQ(prints[0].leg, 2u);
  EXPECT_DOUBLE_EQ(prints[0].x_m, 0.1);
  EXPECT_DOUBLE_EQ(prints[0].y_m, -0.2);
  EXPECT_FLOAT_EQ(prints[0].depth_m, 0.05f);
  EXPECT_DOUBLE_EQ(prints[0].t_s, 152.0 / kControlHz);
  EXPECT_TRUE(maker.take_footprints().empty());
}

TEST(RowMakerTest, ARobotWithoutTruthIsShownAsItMeasuresItself) {
  const RunScene scene{.robot = example_robot()};
  RowMaker maker(scene);
  std::vector<RunRow> rows;
  for (std::uint64_t i = 0; i <= 400; ++i) {
    if (const auto row = maker.add(example_tick(i))) rows.push_back(*row);
  }
  const RunRow& row = rows.back();
  EXPECT_EQ(row.flags & kRowHasTruth, 0u);
  EXPECT_FLOAT_EQ(row.position_rad[11], static_cast<float>(1.1 + 1e-6 * 360));
  EXPECT_FLOAT_EQ(row.peak_torque_nm[0], -2.0f);
  EXPECT_EQ(row.position_m[1], row.odometry[1]);
  EXPECT_GT(row.position_m[1], 0.01);  // it walks to the left by its own reckoning
  EXPECT_NEAR(row.odometry[2], 1.5707963, 1e-6);
  EXPECT_TRUE(std::isnan(row.penetration_m[0]));
  EXPECT_TRUE(std::isnan(row.truth[0]));
}

}  // namespace
}  // namespace sandrunner
