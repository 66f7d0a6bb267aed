// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/check/nudge.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/drivers/robot/example.h"
#include "tools/hil/emulated/emulated_drive.h"

namespace sandrunner {
namespace {

using Found = Nudge::Verdict;

/// Twelve emulated drives, each with a joint of its own that turns freely.
class HangingRobot {
 public:
  explicit HangingRobot(const std::string& example)
      : config(example_hardware(example)), robot(example_robot()) {
    for (int j = 0; j < kNumJoints; ++j) {
      hosts_[j] = Drive(config.drives[j], config);
      drives.emplace_back(config.drives[j], config.drive_timeout_s);
    }
    inertia_kgm2.fill(0.05);
  }

  NudgeExchange exchange() {
    return [this](const NudgePoints& points) { return exchange_once(points); };
  }
  std::string words(const Nudge& nudge, int j) const {
    return nudge_words(nudge, j, config, robot);
  }
  bool all_off() const {
    return std::ranges::all_of(drives, [](const hil::EmulatedDrive& d) { return d.limp(); });
  }

  HardwareConfig config;
  RobotDescription robot;
  std::vector<hil::EmulatedDrive> drives;
  JointArray<double> inertia_kgm2, position_rad{}, velocity_radps{};
  JointArray<double> told_velocity_scale = all(1.0), told_torque_scale = all(1.0);
  double fastest_radps = 0.0, farthest_rad = 0.0;
  double stop_at_s = 1e9;

 private:
  static JointArray<double> all(double value) {
    JointArray<double> values;
    values.fill(value);
    return values;
  }

  NudgeState exchange_once(const NudgePoints& points) {
    for (int j = 0; j < kNumJoints; ++j) {
      CanFrame frame, reply;
      if (!hosts_[j].next_frame(points[j] ? &*points[j] : nullptr, tick_, frame)) continue;
      if (drives[j].answer(frame, time_s(), reply)) hosts_[j].take(reply, tick_);
    }
    for (int i = 0; i < config.ticks_per_exchange(); ++i) step();
    NudgeState state;
    state.time_s = time_s();
    for (int j = 0; j < kNumJoints; ++j) {
      state.position_rad[j] = hosts_[j].position_rad();
      state.velocity_radps[j] = told_velocity_scale[j] * hosts_[j].velocity_radps();
      state.torque_nm[j] = told_torque_scale[j] * hosts_[j].torque_nm();
      state.well[j] = hosts_[j].fault() == 0 && tick_ < hosts_[j].tick() + 80;
    }
    state.stop = time_s() > stop_at_s;
    return state;
  }

  void step() {
    ++tick_;
    for (int j = 0; j < kNumJoints; ++j) {
      const double friction_nm = 0.1 * velocity_radps[j];
      const double torque_nm = drives[j].torque_nm(time_s()) - friction_nm;
      velocity_radps[j] += torque_nm / inertia_kgm2[j] * kControlPeriod_s;
      position_rad[j] += velocity_radps[j] * kControlPeriod_s;
      drives[j].measure(position_rad[j], velocity_radps[j]);
      fastest_radps = std::max(fastest_radps, std::fabs(velocity_radps[j]));
      farthest_rad = std::max(farthest_rad, std::fabs(position_rad[j]));
    }
  }

  double time_s() const { return static_cast<double>(tick_) * kControlPeriod_s; }

  JointArray<Drive> hosts_;
  std::uint64_t tick_ = 0;
};

constexpr int kKfe = 2;

class NudgeTest : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Drives, NudgeTest, testing::Values("mit", "damiao", "moteus"));

TEST_P(NudgeTest, AJointThatGoesTheWayOfTheTorqueIsGoodAndEndsBraked) {
  HangingRobot robot(GetParam());
  const Nudge good = nudge(kKfe, 2.0, {}, robot.exchange());
  EXPECT_EQ(good.verdict, Found::kGood) << robot.words(good, kKfe);
  EXPECT_NEAR(good.reported_nm, 2.0, 0.1);
  EXPECT_NEAR(good.travelled_rad, good.moved_rad, 0.02);
  EXPECT_LT(robot.fastest_radps, 3.5);
  EXPECT_LT(robot.farthest_rad, 0.3);
  EXPECT_LT(std::fabs(robot.velocity_radps[kKfe]), 0.2);
  EXPECT_TRUE(robot.all_off());
  EXPECT_THAT(robot.words(good, kKfe), testing::StartsWith("LF_KFE (can0 id 3): +2.0 N m moved"));
  EXPECT_THAT(robot.words(good, kKfe), testing::EndsWith("+2.0 N m"));
}

TEST_P(NudgeTest, ATorqueReportedInAnotherScaleIsSaidWithItsSetting) {
  HangingRobot robot(GetParam());
  robot.told_torque_scale[kKfe] = 1.25;
  const Nudge good = nudge(kKfe, 2.0, {}, robot.exchange());
  EXPECT_EQ(good.verdict, Found::kGood);
  EXPECT_THAT(robot.words(good, kKfe), testing::HasSubstr("reported_torque = 1.2"));
}

TEST_P(NudgeTest, ADriveWhoseTorqueHasTheWrongSignIsFoundAndNeverDamps) {
  HangingRobot robot(GetParam());
  robot.drives[kKfe].faults().reversed = true;
  const Nudge wrong = nudge(kKfe, 2.0, {}, robot.exchange());
  EXPECT_EQ(wrong.verdict, Found::kWrongSign) << robot.words(wrong, kKfe);
  EXPECT_LT(robot.fastest_radps, 3.5);
  EXPECT_TRUE(robot.all_off());
  EXPECT_THAT(robot.words(wrong, kKfe), testing::HasSubstr("its torque has the wrong sign"));
}

TEST_P(NudgeTest, ALightJointIsStoppedBeforeItIsFast) {
  HangingRobot robot(GetParam());
  robot.inertia_kgm2.fill(0.008);
  const Nudge light = nudge(kKfe, 2.0, {}, robot.exchange());
  EXPECT_EQ(light.verdict, Found::kGood) << robot.words(light, kKfe);
  EXPECT_LT(robot.fastest_radps, 4.5);
  EXPECT_LT(robot.farthest_rad, 0.3);
}

TEST_P(NudgeTest, DampedJointsGetNothingElse) {
  HangingRobot robot(GetParam());
  JointArray<bool> damped{};
  damped[4] = true;
  const Nudge good = nudge(kKfe, 2.0, damped, robot.exchange());
  EXPECT_EQ(good.verdict, Found::kGood);
  EXPECT_EQ(robot.drives[4].kp_nmprad(), 0.0);
  EXPECT_NEAR(robot.drives[4].kd_nmsprad(), 2.0, 0.01);
  EXPECT_TRUE(robot.drives[5].limp());
}

TEST_P(NudgeTest, ADriveThatGivesNoTorqueMovesNothing) {
  HangingRobot robot(GetParam());
  robot.inertia_kgm2[kKfe] = 1e6;
  EXPECT_EQ(nudge(kKfe, 2.0, {}, robot.exchange()).verdict, Found::kNotMoved);
}

TEST_P(NudgeTest, VelocityAndTorqueThatMeanSomethingElseAreFound) {
  HangingRobot velocity(GetParam());
  velocity.told_velocity_scale[kKfe] = 0.4;
  EXPECT_EQ(nudge(kKfe, 2.0, {}, velocity.exchange()).verdict, Found::kWrongSpeed);
  velocity.told_velocity_scale[kKfe] = -1.0;
  EXPECT_EQ(nudge(kKfe, 2.0, {}, velocity.exchange()).verdict, Found::kWrongSpeed);
  HangingRobot torque(GetParam());
  torque.told_torque_scale[kKfe] = 0.37;
  EXPECT_EQ(nudge(kKfe, 2.0, {}, torque.exchange()).verdict, Found::kWrongTorque);
}

TEST_P(NudgeTest, APersonsStopAndADriveThatFallsSilentEndIt) {
  HangingRobot stopped(GetParam());
  stopped.stop_at_s = 1.1;  // in the push
  EXPECT_EQ(nudge(kKfe, 2.0, {}, stopped.exchange()).verdict, Found::kStopped);
  EXPECT_TRUE(stopped.all_off());
  HangingRobot silent(GetParam());
  silent.drives[7].faults().silent = true;
  const Nudge ended = nudge(kKfe, 2.0, {}, silent.exchange());
  EXPECT_EQ(ended.verdict, Found::kNotWell);
  EXPECT_EQ(ended.other, 7);
  EXPECT_EQ(silent.fastest_radps, 0.0);
}

TEST_P(NudgeTest, AJointThatSwingsIsNotPushed) {
  HangingRobot robot(GetParam());
  robot.inertia_kgm2[1] = 10.0;
  robot.velocity_radps[1] = 1.0;
  const Nudge restless = nudge(kKfe, 2.0, {}, robot.exchange());
  EXPECT_EQ(restless.verdict, Found::kNotStill);
  EXPECT_EQ(restless.other, 1);
}

}  // namespace
}  // namespace sandrunner
