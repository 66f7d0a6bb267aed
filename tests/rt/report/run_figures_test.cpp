// SPDX-License-Identifier: BSD-3-Clause
// Figures and record of a run stay small, however long it is.
#include "rt/report/run_figures.h"

#include <gtest/gtest.h>

#include "rt/report/run_observer.h"

namespace sandrunner {
namespace {

constexpr int kPeriods = 100'000;  // of the policy: 17 minutes

// A walk whose speed grows by 1 mm/s in every period.
TickRecord walk_tick(std::uint64_t tick) {
  TickRecord record;
  record.input.sensors.tick = tick;
  record.counts = record.has_truth = 1;
  const std::uint64_t period = tick / kTicksPerPolicyStep;
  record.truth.velocity_mps = {1e-3 * static_cast<double>(period), 0.0, 0.0};
  record.truth.joint_torque_nm[3] = 2.0;
  record.before.joint_velocity_radps[3] = 5.0;
  record.truth.joint_velocity_radps[3] = 7.0;
  record.output.policy_input.command = {.vx_mps = 1.5, .vy_mps = 0.0, .wz_radps = 0.0};
  record.truth.foot_penetration_m.fill(-0.1);
  record.truth.foot_penetration_m[1] = tick % 4000 < 2000 ? 0.03 : -0.1;
  return record;
}

RunRecord record_of(std::uint64_t ticks, std::uint64_t step) {
  RunObserver observer({.mass_kg = 10.0, .motor_constant = {3.0, 3.0, 3.0}});
  for (std::uint64_t tick = 0; tick < ticks; tick += step) observer.add(walk_tick(tick));
  return observer.take_record();
}

TEST(RunFiguresTest, OfAWalkOfAQuarterOfAnHourTheSecondHalfCounts) {
  const RunFigures figures = run_figures(record_of(kPeriods * kTicksPerPolicyStep, 1));
  EXPECT_NEAR(figures.motion->mean_velocity_mps[0], 1e-3 * (0.75 * kPeriods - 0.5), 2.1e-3);
  EXPECT_NEAR(figures.mean_command_mps[0], 1.5, 1e-6);
  EXPECT_NEAR(figures.mechanical_power_w, 10.0, 1e-6) << "torque times the speed before the step";
  EXPECT_EQ(figures.motion->stances, kPeriods / 200);
  EXPECT_NEAR(figures.motion->sinkage_mean_m, 0.03, 1e-6);
}

TEST(RunFiguresTest, OnlyRowsOfTheWalkCount) {
  RunObserver observer({.mass_kg = 10.0, .motor_constant = {3.0, 3.0, 3.0}});
  for (std::uint64_t tick = 0; tick <= 400 * kTicksPerPolicyStep; ++tick) {
    TickRecord record = walk_tick(tick);
    const std::uint64_t period = (tick + kTicksPerPolicyStep - 1) / kTicksPerPolicyStep;
    record.counts = period > 100 && period <= 300 ? 1 : 0;
    record.counters.joint_too_fast = tick;
    record.truth.velocity_mps = {record.counts != 0 ? 2.0 : 50.0, 0.0, 0.0};
    observer.add(record);
  }
  const RunFigures figures = run_figures(observer.take_record());
  EXPECT_NEAR(figures.motion->mean_velocity_mps[0], 2.0, 1e-6);
  EXPECT_EQ(figures.speed_limit_steps, 100 * kTicksPerPolicyStep);
  EXPECT_EQ(figures.motion->stances, 1);
  EXPECT_FALSE(run_figures({}).motion);
}

TEST(RunFiguresTest, HowMuchOfTheCommandWasFollowed) {
  RunFigures figures;
  figures.mean_command_mps = {1.0, 0.0};
  figures.motion.emplace();
  EXPECT_EQ(figures.followed(), 0.0) << "it stood";
  figures.motion->mean_velocity_mps = {0.5, 0.4};
  EXPECT_EQ(figures.followed(), 0.5);
  figures.motion->mean_velocity_mps = {-1.0, 0.0};
  EXPECT_EQ(figures.followed(), -1.0);
  figures.mean_command_mps = {0.0, 0.0};
  EXPECT_FALSE(figures.followed());
  figures.mean_yaw_command_radps = 1.0;
  figures.motion->mean_yaw_rate_radps = 0.75;
  EXPECT_EQ(figures.followed(), 0.75);
  figures.motion.reset();
  EXPECT_FALSE(figures.followed());
}

TEST(RunRecordTest, ARunOfAQuarterOfAnHourHasEverySecondPeriod) {
  const RunRecord record = record_of(kPeriods * kTicksPerPolicyStep, kTicksPerPolicyStep);
  ASSERT_EQ(record.rows.size(), kPeriods / 2);
  for (std::size_t i = 0; i < record.rows.size(); ++i) {
    ASSERT_NEAR(record.rows[i].t_s, 0.02 * static_cast<double>(i) + 0.01, 1e-9) << i;
  }
}

TEST(RunRecordTest, ARowThatIsLeftOutHandsItsExtremesAndItsShareInTheMeansOn) {
  RunRecord record;
  for (int i = 0; i < 8; ++i) {
    RunRow row;
    row.t_s = i;
    row.power_w = static_cast<float>(i);
    row.peak_torque_nm[4] = i == 1 ? -40.0f : 1.0f;
    row.late_us = i == 2 ? 90.0f : 1.0f;
    record.add(row);
  }
  record.thin();
  record.thin();
  for (int i = 8; i < 12; ++i) {
    RunRow row;
    row.t_s = i;
    row.power_w = static_cast<float>(i);
    record.add(row);
  }
  ASSERT_EQ(record.rows.size(), 3u);
  EXPECT_EQ(record.rows[2].t_s, 11.0);
  EXPECT_FLOAT_EQ(record.rows[2].power_w, 9.5f);
  EXPECT_EQ(record.rows[0].t_s, 3.0);
  EXPECT_FLOAT_EQ(record.rows[0].power_w, 1.5f);
  EXPECT_EQ(record.rows[0].peak_torque_nm[4], -40.0f);
  EXPECT_EQ(record.rows[0].late_us, 90.0f);
}

TEST(RunRecordTest, APeriodWhoseFirstTickIsMissingHasARowAllTheSame) {
  RunObserver observer({});
  for (std::uint64_t tick = 0; tick < 3 * kTicksPerPolicyStep; ++tick) {
    if (tick != kTicksPerPolicyStep) observer.add(walk_tick(tick));
  }
  const RunRecord record = observer.take_record();
  ASSERT_EQ(record.rows.size(), 3u);
  EXPECT_NEAR(record.rows[1].t_s, 0.01025, 1e-9);
}

}  // namespace
}  // namespace sandrunner
