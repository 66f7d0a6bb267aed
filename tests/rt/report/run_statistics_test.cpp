// SPDX-License-Identifier: BSD-3-Clause
// Figures and record of a run stay small, however long it is.
#include "rt/report/run_statistics.h"

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

TEST(RunStatisticsTest, OfAWalkOfAQuarterOfAnHourTheSecondHalfCounts) {
  RunStatistics statistics;
  for (std::uint64_t tick = 0; tick < kPeriods * kTicksPerPolicyStep; ++tick) {
    statistics.add(walk_tick(tick), nullptr);
  }
  EXPECT_EQ(statistics.time_s(), 0.01 * kPeriods);
  const RunFigures figures = statistics.figures(10.0, 3.0);
  EXPECT_NEAR(figures.motion->mean_velocity_mps[0], 1e-3 * (0.75 * kPeriods - 0.5), 1.1e-3);
  EXPECT_NEAR(figures.mean_command_mps[0], 1.5, 1e-9);
  EXPECT_NEAR(figures.mechanical_power_w, 10.0, 1e-9) << "torque times the speed before the step";
  EXPECT_EQ(figures.motion->stances, kPeriods / 200);
  EXPECT_NEAR(figures.motion->sinkage_mean_m, 0.03, 1e-12);
}

TEST(RunStatisticsTest, TheRecordOfAQuarterOfAnHourHasEverySecondPeriod) {
  RunScene scene;
  scene.leg_points = [](const JointArray<double>&) { return std::array<LegPoints, kNumLegs>{}; };
  RunObserver observer(scene, true, {});
  for (std::uint64_t period = 0; period < kPeriods; ++period) {
    observer.add(walk_tick(period * kTicksPerPolicyStep));
  }
  const RunRecord record = observer.take_record();
  ASSERT_EQ(record.samples.size(), kPeriods / 2);
  for (std::size_t i = 0; i < record.samples.size(); ++i) {
    ASSERT_NEAR(record.samples[i].t_s, 0.02 * static_cast<double>(i), 1e-9) << i;
  }
}

TEST(RunStatisticsTest, APeriodWhoseFirstTickIsMissingHasARowAllTheSame) {
  RunScene scene;
  scene.leg_points = [](const JointArray<double>&) { return std::array<LegPoints, kNumLegs>{}; };
  RunObserver observer(scene, true, {});
  for (std::uint64_t tick = 0; tick < 3 * kTicksPerPolicyStep; ++tick) {
    if (tick != kTicksPerPolicyStep) observer.add(walk_tick(tick));
  }
  const RunRecord record = observer.take_record();
  ASSERT_EQ(record.samples.size(), 3u);
  EXPECT_NEAR(record.samples[1].t_s, 0.01025, 1e-9);
}

}  // namespace
}  // namespace sandrunner
