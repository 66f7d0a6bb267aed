// SPDX-License-Identifier: BSD-3-Clause
// The definitions of the figures, on a run made by hand.
#include "tools/evaluate/trial_figures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

namespace sandrunner::evaluate {
namespace {

class TrialFiguresTest : public testing::Test {
 protected:
  TrialFiguresTest() {
    facts_.mass_kg = 20.0;
    facts_.motor_constant = 3.0;
    facts_.foot_diagonal_m = 0.7;
    facts_.torque_limit_nm.fill(60.0);
    trial_.duration_s = 6.0;
    trial_.track_begin_m = 1.0;
    trial_.track_end_m = 6.0;
    sums_.power = 100.0f * kTicksPerPolicyStep;
    sums_.extension_power = 40.0f * kTicksPerPolicyStep;
    sums_.torque_squared = 900.0f * kTicksPerPolicyStep;
    command_.vx_mps = 1.5;
  }

  /// A fresh run over the track at 1 m/s; ticks past a stop in the period of each number.
  template <typename Stops>
  void walk(const Stops& ticks_past_stop) {
    recorder_ = {};
    for (int i = 0; i < 650; ++i) {
      sums_.ticks_past_stop = ticks_past_stop(i);
      period(1.0f);
    }
  }

  /// One period at this speed; all feet down for a quarter of a second, then up for as long.
  void period(float vx, float vy = 0.0f, float yaw_rate = 0.0f) {
    sim::RobotState<float> state;
    state.rigid.velocity = {vx, vy, 0.0f};
    state.rigid.angular_velocity.z = yaw_rate;
    StateEstimate truth, estimate;
    truth.velocity_mps = {vx, vy, 0.0};
    estimate.velocity_mps = {vx + 0.3, vy - 0.4, 0.0};
    truth.body_height_m = 0.5;
    // Feet rise as fast as each other's number says: from 0 to 40, 80, 120 and 160 mm.
    for (int l = 0; l < kNumLegs; ++l) {
      truth.foot_height_m[l] = 0.04 * (l + 1) * (periods_ % 50) / 49.0;
    }
    estimate.foot_height_m = truth.foot_height_m;
    estimate.body_height_m = 0.51;
    JointArray<double> before{}, target{};
    target[0] = 0.03;
    target[5] = -0.04;
    recorder_.begin_period(state, truth, estimate, command_, before, target, 50.0, 0.5, facts_);
    const bool down = periods_ % 50 < 25;
    sums_.foot_load.fill(down ? 60.0f * kTicksPerPolicyStep : 0.0f);
    recorder_.end_period(sums_);
    ++periods_;
  }
  TrialFigures figures(bool fell = false, bool met = false) {
    return recorder_.figures(trial_, fell, met, facts_);
  }

  RobotFacts facts_;
  Trial trial_;
  VelocityCommand command_;
  sim::BatchSums<float> sums_;
  TrialRecorder recorder_;
  int periods_ = 0;
};

TEST_F(TrialFiguresTest, SteadyRunHasTheFiguresOfTheirDefinitions) {
  for (int i = 0; i < 700; ++i) period(1.0f, 0.2f, -0.1f);
  const TrialFigures f = figures();
  EXPECT_NEAR(f.time_s, 7.0, 1e-9);
  EXPECT_TRUE(f.track_done);
  EXPECT_TRUE(f.track_limits_kept);
  EXPECT_NEAR(f.track_speed_mps, 1.0, 1e-4);
  EXPECT_NEAR(f.track_end_speed_mps, 1.0, 1e-4);
  EXPECT_NEAR(f.vx_mps, 1.0, 1e-5);
  EXPECT_NEAR(f.vy_mps, 0.2, 1e-5);
  EXPECT_NEAR(f.yaw_rate_radps, -0.1, 1e-5);
  // 100 W mechanical and 900/9 W of heat.
  EXPECT_NEAR(f.track_cot, 200.0 / (20.0 * 9.81), 1e-4);
  EXPECT_NEAR(f.cot, 200.0 / (20.0 * 9.81 * std::hypot(1.0, 0.2)), 1e-4);
  EXPECT_NEAR(f.turning_cot, 200.0 / (20.0 * 9.81 * 0.7 * 0.1), 1e-3);
  EXPECT_NEAR(f.leg_extension_power_w, 40.0, 1e-4);
  EXPECT_NEAR(f.turned_rad, -0.7, 1e-5);
  EXPECT_NEAR(f.least_clearance_iqr_m, 0.02, 1e-3);
  EXPECT_NEAR(f.clearance_iqr_m, 0.05, 2e-3);
  EXPECT_NEAR(f.greatest_clearance_iqr_m, 0.08, 2e-3);
  EXPECT_NEAR(f.stride_hz, 2.0, 1e-9);
  EXPECT_NEAR(f.duty, 0.5, 1e-9);
  EXPECT_NEAR(f.action_change_rad, 0.05, 1e-6);
  EXPECT_NEAR(f.velocity_rmse_mps, 0.5, 1e-5);
  EXPECT_NEAR(f.body_height_rmse_m, 0.01, 1e-6);
  EXPECT_NEAR(f.velocity_error_mps, std::hypot(0.5, 0.2), 1e-5);
  EXPECT_NEAR(f.yaw_error_radps, 0.1, 1e-6);
  EXPECT_NEAR(f.body_height_m, 0.5, 1e-6);
  EXPECT_EQ(f.tilt_rms_rad, 0.0);
  EXPECT_EQ(f.torque_limit_share, 0.0);
}

TEST_F(TrialFiguresTest, TopSpeedIsOfTheLastGaitCycleOfTheTrack) {
  // The end of the track is reached in period 550; a gait cycle is 0.5 s.
  for (int i = 0; i < 800; ++i) period(i >= 500 && i < 550 ? 2.0f : i < 200 ? 0.9f : 1.0667f);
  EXPECT_NEAR(figures().track_speed_mps, 5.0 / (0.01 * (550 - 111)), 0.02);
  EXPECT_NEAR(figures().track_end_speed_mps, 2.0, 0.05);
}

TEST_F(TrialFiguresTest, DisturbanceIsMetOrNotOrThereIsNone) {
  period(1.0f);
  EXPECT_TRUE(std::isnan(figures(false, false).disturbance_met));
  trial_.ground_changes_at_m = 2.0;
  EXPECT_EQ(figures(false, false).disturbance_met, 0.0);
  EXPECT_EQ(figures(false, true).disturbance_met, 1.0);
}

TEST_F(TrialFiguresTest, FallLeavesNoSteadyFigures) {
  for (int i = 0; i < 300; ++i) period(1.0f);
  const TrialFigures f = figures(true);
  EXPECT_TRUE(f.fell);
  EXPECT_FALSE(f.track_done);
  EXPECT_FALSE(f.track_limits_kept);
  EXPECT_TRUE(std::isnan(f.track_speed_mps));
  EXPECT_TRUE(std::isnan(f.vx_mps));
  EXPECT_TRUE(std::isnan(f.cot));
  EXPECT_NEAR(f.velocity_error_mps, 0.5, 1e-5);
}

TEST_F(TrialFiguresTest, FallBehindTheTrackIsNoFailureOfTheTrack) {
  for (int i = 0; i < 650; ++i) period(1.0f);
  EXPECT_TRUE(figures(true).track_done);
}

TEST_F(TrialFiguresTest, StopCountsUpToTheEndOfTheTrack) {
  walk([](int i) { return i == 640 ? 4.0f : 0.0f; });
  EXPECT_TRUE(figures().track_limits_kept);
  EXPECT_NEAR(figures().past_stop_share, 4.0 / (650.0 * kTicksPerPolicyStep), 1e-9);
  walk([](int i) { return i == 500 ? 1.0f : 0.0f; });
  EXPECT_TRUE(figures().track_done);
  EXPECT_FALSE(figures().track_limits_kept);
  EXPECT_TRUE(figures().track_stops_brief);
}

TEST_F(TrialFiguresTest, StopOfAPolicyStepIsNotBriefWhereverItBegins) {
  const std::tuple<float, float, bool> cases[] = {
      {40.0f, 0.0f, false}, {15.0f, 25.0f, false}, {15.0f, 24.0f, true}};
  for (const auto& [first, second, brief] : cases) {
    walk([begin = first, end = second](int i) { return i == 500 ? begin : i == 501 ? end : 0.0f; });
    EXPECT_EQ(figures().track_stops_brief, brief) << first << " " << second;
    EXPECT_FALSE(figures().failed_before_track);
  }
}

TEST_F(TrialFiguresTest, FailureBeforeTheStartLineIsAFallOrAStopThere) {
  for (int i = 0; i < 90; ++i) period(1.0f);
  EXPECT_TRUE(figures(true).failed_before_track);
  EXPECT_FALSE(figures(false).failed_before_track);  // only slow
  for (int i = 90; i < 110; ++i) period(1.0f);
  EXPECT_FALSE(figures(true).failed_before_track);
  walk([](int i) { return i == 50 ? 40.0f : 0.0f; });
  EXPECT_TRUE(figures().track_done);
  EXPECT_TRUE(figures().failed_before_track);
}

TEST_F(TrialFiguresTest, SlowRunDoesNotReachTheEnd) {
  trial_.longest_s = 4.0;
  for (int i = 0; i < 650; ++i) period(1.0f);
  EXPECT_FALSE(figures().track_done);
}

TEST(CommandScriptTest, StaysZeroThenRisesToTheTarget) {
  const CommandScript ramp{{3.0, 0.0, 0.5}, 0.5, 2.0};
  EXPECT_EQ(ramp.at(0.49).vx_mps, 0.0);
  EXPECT_NEAR(ramp.at(1.25).vx_mps, 1.5, 1e-12);
  EXPECT_NEAR(ramp.at(1.25).wz_radps, 0.25, 1e-12);
  EXPECT_EQ(ramp.at(2.0).vx_mps, 3.0);
  EXPECT_EQ(ramp.at(20.0).wz_radps, 0.5);
  const CommandScript step{{-1.0, 0.0, 0.0}, 0.0, INFINITY};
  EXPECT_EQ(step.at(0.0).vx_mps, -1.0);
  EXPECT_EQ(CommandScript{}.at(3.0).vx_mps, 0.0);
}

}  // namespace
}  // namespace sandrunner::evaluate
